#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <cstdint>

namespace fluidcarve {

/// Moves a staggered velocity (OpenVDB's GRID_STAGGERED: component c of voxel ijk is at the face at
/// ijk - e_c / 2) to the voxel centres: component c becomes the mean of the faces of ijk and ijk +
/// e_c. Inactive faces count with their stored value. Active voxels, name, transform and background
/// stay; the class becomes unknown.
/// @return the grid itself if it is not staggered
/// @throws Failure naming the grid and the voxel if a value is not finite
Ref<VectorGrid> collocated(const Ref<VectorGrid>& velocity);

/// Checks, before `collocated`, that its result fits in memory.
/// @param budget  as in grid_fits
/// @throws Failure as require_dense_fits
void require_collocation_fits(const VectorGrid& velocity, std::uint64_t budget);

}  // namespace fluidcarve
