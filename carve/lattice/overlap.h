#pragma once

#include "carve/lattice/mapping.h"

#include <openvdb/math/Transform.h>

#include <cstddef>

namespace fluidcarve {

/// Number of voxels that lie in several cells, because the lattice meets itself. Each is carved in
/// the lowest cell only.
struct Overlap {
    std::size_t voxels = 0;
    /// Lower plane of the slab that keeps most of these voxels; the first such plane.
    int plane = 0;
};

/// Counts the voxels that lie in several cells, among all voxels of a transform, active or not. A
/// straight box has none. Folded cells hold no voxels and are not counted. Voxels are visited only
/// where slabs meet that no plane separates, judged by the slabs' corners.
/// @param mapping    with the extent that insertions will need
/// @param transform  linear; that of the grids to carve, or cubes as large as the lattice's spacing
Overlap count_overlap(const Mapping& mapping, const openvdb::math::Transform& transform);

}  // namespace fluidcarve
