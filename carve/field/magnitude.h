#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// The length of each vector.
/// @param vectors  any unit; a staggered grid is collocated first
/// @return lengths in the unit of `vectors`, on their active voxels; the background is the length
///   of theirs
/// @throws Failure naming the grid and the voxel if a value is not finite
FloatGrid::Ptr magnitude_field(const Ref<VectorGrid>& vectors);

}  // namespace fluidcarve
