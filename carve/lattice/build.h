#pragma once

#include "carve/lattice/folds.h"
#include "carve/lattice/lattice.h"
#include "carve/rig/rig.h"

#include <array>
#include <optional>

namespace fluidcarve {

/// What to smooth where planes cross (paper 3.4): the rig's points (sideways, to the mean of
/// themselves and their neighbours), the planes' directions, or nothing.
enum class Smooth { points, directions, none };

/// Parameters of build_lattice().
struct LatticeSpec {
    double spacing = 0;  ///< distance of neighbouring vertices, world units, above 0
    /// Extents around the rig: lower end, upper end; world units; lower < upper.
    std::array<double, 2> u{}, v{};
    bool around = false;       ///< u is the distance from the rig, from 0 to the upper end; v goes
                               ///< around the rig, and its extent is not used
    bool flip_u = false;       ///< reverses u; the lattice is then left-handed
    bool closed_form = false;  ///< uses the paper's plane directions and inverse
    Smooth smooth = Smooth::points;
    int max_iterations = 0;  ///< of smoothing
};

/// A lattice and how it was built.
struct BuiltLattice {
    Lattice lattice;
    double step = 0;  ///< distance of neighbouring planes along the rig, world units; differs from
                      ///< the spacing for closed rigs and stated planes
    int iterations = 0;  ///< smoothing iterations done
    double moved = 0;    ///< largest distance by which smoothing moved the rig, world units
    Folds folds;         ///< folded cells that remain
};

/// Builds a lattice along a rig (METHOD 2, paper 3.1 and 3.4), with description and hash. The first
/// vertices lie at the lower ends of the extents, the last ones at the upper ends or less than a
/// spacing below.
/// @param planes  number of planes; nothing: as many as the spacing gives. A stated number changes
///   the distance of planes along the rig
/// @throws Failure if the rig has a rig_fault(), starts along its `up`, or cannot be resampled
BuiltLattice build_lattice(const Rig& rig, const LatticeSpec& spec,
                           std::optional<int> planes = std::nullopt);

/// Number of vertices along an extent, from its lower end up to at most its upper end.
/// @param extent   lower and upper end, world units
/// @param spacing  world units
double vertices_along(const std::array<double, 2>& extent, double spacing);

/// The part of a lattice's form that follows from the spec alone. The rig determines K and
/// `closed`.
LatticeForm form_of(const LatticeSpec& spec);

/// Whether a lattice reaches past the centre of a circular rig. Smoothing cannot unfold it then.
bool reaches_across(const Rig& rig, const LatticeSpec& spec);

}  // namespace fluidcarve
