#pragma once

#include "nodes/lattice/lattice.h"
#include "nodes/seams/carve_step.h"
#include "nodes/seams/seams.h"
#include "nodes/seams/smooth_displacement.h"

#include <openvdb/Types.h>
#include <openvdb/math/BBox.h>
#include <openvdb/math/Coord.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace fluidcarve {

/// A chain of seam sets in one frame (METHOD 4): each is carved from what those before it leave. To find what stands
/// at a carved vertex, the last step is asked first. A vertex that no step's lattice holds stays where it is; one that
/// a removal frees at an end is background.
/// Coordinates are those of extended(): the lattice, and beyond its first vertices what anchored insertions add there.
class CarveMap {
public:
    /// @param sets   in the order of carving
    /// @param frame  a frame number
    /// @param count  how many seams of the last set; nothing: all
    /// @throws Failure if a set belongs to another lattice or misses the frame, shapes do not chain, or count is too high
    CarveMap(const Lattice& lattice, const std::vector<std::shared_ptr<const Seams>>& sets, int frame, std::optional<std::size_t> count,
             const Softness& softness = {});

    /// The lattice in whose index coordinates the map is: the given one, but that its first vertices along `u` and `v` may lie further out.
    Lattice extended(const Lattice& lattice) const;

    /// Lets displacements go linearly to 0 towards lateral rims and open ends, where they else end with a jump (METHOD 4,
    /// "Tears"): what stands at a point comes from `u + s (m - u)` instead of `m`, `s` from 0 to 1 (CarveStep::scale). `m`
    /// never falls along the axis, so neither does this: the map does not fold. What a removal frees, or an insertion adds
    /// beyond the lattice, shrinks by `s` too. As far as `vertices` from rims and ends
    /// and beyond, nothing changes.
    /// @param vertices  above 0, over which they go to 0
    /// @throws Failure if the lattice is so thin that no vertex would move as far as asked for
    void fade(double vertices);
    bool fades() const;
    /// Whether displacements of some step are smoothed.
    bool soft() const;

    /// Sets without seams are left out.
    const std::vector<CarveStep>& steps() const { return steps_; }
    bool empty() const { return steps_.empty(); }
    /// Vertices per dimension that carving may write: the extended lattice and what insertions add along the way.
    const std::array<int, 3>& reach() const { return reach_; }

    /// What a box of carved lattice coordinates is made of.
    /// @param range  grows to hold all coordinates that its points come from, itself included
    /// @param frees  set if part of it becomes background
    /// @return false if nothing in it moves
    bool trace(openvdb::BBoxd& range, bool& frees) const;
    /// A box of lattice coordinates outside which nothing moves.
    openvdb::BBoxd moved() const;

private:
    std::vector<CarveStep> steps_;
    std::array<int, 3> reach_;
    std::array<int, 2> below_{};  ///< vertices that come before the lattice's first, along u and v
};

}  // namespace fluidcarve
