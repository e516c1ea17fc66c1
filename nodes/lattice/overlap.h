#pragma once

#include "nodes/lattice/mapping.h"

#include <openvdb/math/Transform.h>

#include <cstddef>

namespace fluidcarve {

/// Voxels that lie in several cells of a lattice, since it meets itself: each is carved in the lowest one only.
struct Overlap {
    std::size_t voxels = 0;
    int plane = 0;  ///< below most of them: the lower plane of the cells that keep them; the first such plane
};

/// Counts them among all voxels of a transform, active or not. A straight box has none. Cells that are folded hold
/// nothing, and are not counted. Where planes separate all slabs, which is known by their corners, no voxel is looked at;
/// else those where slabs meet that no plane separates.
/// @param mapping    with the extent that insertions will need
/// @param transform  linear; of the grids to carve, or of cubes as large as the lattice's spacing
Overlap count_overlap(const Mapping& mapping, const openvdb::math::Transform& transform);

}  // namespace fluidcarve
