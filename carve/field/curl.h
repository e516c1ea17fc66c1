#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// The curl of a velocity, by central differences (paper eq. 11): along the axis of rotation, twice
/// as long as its angular velocity.
/// @param velocity  world units per second, with cubic voxels along the world's axes; a staggered
///   grid is collocated first. Inactive voxels count with their stored value (0 in most files)
/// @return 1/s, on the active voxels of `velocity`
/// @throws Failure naming the grid if its voxels are not cubes along the world's axes, or a value
///   is not finite
VectorGrid::Ptr curl_field(const Ref<VectorGrid>& velocity);

}  // namespace fluidcarve
