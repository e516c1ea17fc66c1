#pragma once

#include "nodes/lattice/folds.h"
#include "nodes/lattice/lattice.h"
#include "nodes/rig/rig.h"

#include <array>
#include <optional>

namespace fluidcarve {

/// What is smoothed where planes cross (paper 3.4): points sideways by the mean of their neighbours, or directions.
enum class Smooth { points, directions, none };

struct LatticeSpec {
    double spacing = 0;              ///< world units, above 0
    std::array<double, 2> u{}, v{};  ///< extents around the rig, world units, the second above the first
    bool flip_u = false;             ///< u the other way; the lattice is then left-handed
    bool closed_form = false;        ///< the paper's directions and inverse
    Smooth smooth = Smooth::points;
    int max_iterations = 0;
};

struct BuiltLattice {
    Lattice lattice;
    double step = 0;     ///< of the rig's points from plane to plane, world units; the spacing, but for closed rigs and stated planes
    int iterations = 0;  ///< of smoothing
    double moved = 0;    ///< how far the smoothing took the rig at most, world units
    Folds folds;         ///< that are left
};

/// A lattice along a rig (METHOD 2, paper 3.1 and 3.4), described and hashed. The first vertices lie at the lower extents,
/// the last at most at the upper ones.
/// @param planes  how many, instead of as many as the spacing makes: their distance along the rig changes
/// @throws Failure if the rig has a rig_fault, runs along `up` at its start, or cannot be resampled
BuiltLattice build_lattice(const Rig& rig, const LatticeSpec& spec, std::optional<int> planes = std::nullopt);

/// Vertices from the lower end of an extent at most to its upper end.
double vertices_along(const std::array<double, 2>& extent, double spacing);

/// Whether a rig is a circle that the lattice reaches across, past its centre: no smoothing cures that.
bool reaches_across(const Rig& rig, const LatticeSpec& spec);

}  // namespace fluidcarve
