#pragma once

#include "carve/base/values.h"
#include "carve/lattice/lattice.h"
#include "carve/seam/carve_step.h"
#include "carve/seam/seams.h"
#include "carve/seam/smooth_displacement.h"

#include <openvdb/Types.h>
#include <openvdb/math/BBox.h>
#include <openvdb/math/Coord.h>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace fluidcarve {

/// A chain of seam sets and warps in one frame (METHOD 4). Each set is carved from the result of
/// the sets before it. To find the source of a carved vertex, the steps are applied from the last
/// to the first. A vertex outside a step's lattice stays in place. A vertex that a removal frees
/// at an end becomes background.
/// Coordinates are those of extended(): the lattice, and before its first vertices those that
/// anchored insertions add.
class CarveMap {
public:
    /// @param sets      in the order of carving
    /// @param frame     frame number
    /// @param count     number of seams used of the last set; nothing: all
    /// @param softness  of the seams of each set; sets beyond the span get none. A warp is already
    ///   smooth.
    /// @throws Failure if a set is of frames, belongs to another lattice or misses the frame, if
    ///   shapes do not chain, or if count is too high
    CarveMap(const Lattice& lattice, const std::vector<Ref<Seams>>& sets, int frame,
             std::optional<std::size_t> count, std::span<const Softness> softness = {});

    /// The lattice in whose index coordinates the map works: the given one, extended before its
    /// first vertices and behind its last plane as anchored insertions need.
    Lattice extended(const Lattice& lattice) const;
    /// Number of vertices before the lattice's first ones.
    const std::array<int, 3>& below() const { return below_; }

    /// Fades displacements linearly to 0 towards lateral rims and open ends. Without a fade they
    /// end there with a jump (METHOD 4 "Tears"). A point's content then comes from `u + s (m - u)`
    /// instead of `m`, with `s` from 0 to 1 (CarveStep::rim_scale). `m` never falls along the axis,
    /// so the faded map does not fold. The entries that a removal frees, or an insertion adds
    /// beyond the lattice, shrink by `s` too. Nothing changes at `vertices` or more from rims and
    /// ends.
    /// @param vertices  length of the fade, above 0
    /// @throws Failure if the lattice is so thin that no vertex would move by its full
    ///   displacement
    void fade_rims(double vertices);
    bool rims_fade() const;
    /// Whether any step has smooth displacements: a warp, or softened seams.
    bool soft() const;
    /// Whether the seams of any step are joined by a fade.
    bool joins() const;

    /// One step per set; sets without seams have none.
    const std::vector<CarveStep>& steps() const { return steps_; }
    bool empty() const { return steps_.empty(); }
    /// Vertices per dimension that carving may write: the extended lattice and what insertions add.
    const std::array<int, 3>& reach() const { return reach_; }

    /// Finds where the content of a box of carved lattice coordinates comes from.
    /// @param range  the box; grows to hold all source coordinates as well
    /// @param frees  set to true if part of the box becomes background, else unchanged
    /// @return false if nothing in the box moves
    bool trace(openvdb::BBoxd& range, bool& frees) const;
    /// The box of all carved lattice coordinates.
    openvdb::BBoxd whole() const;
    /// A box of lattice coordinates outside which nothing moves.
    openvdb::BBoxd moved() const;

private:
    std::vector<CarveStep> steps_;
    std::array<int, 3> reach_;
    std::array<int, 3> below_{};
    int behind_ = 0;  ///< number of planes behind the lattice's last one
};

}  // namespace fluidcarve
