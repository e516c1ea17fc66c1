#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// Energy that is high where the flow rotates: gain |curl v|, by central differences (paper eq. 11,
/// first term).
/// @param velocity  world units per second, with cubic voxels along the world's axes; a staggered
///   grid is collocated first. Inactive voxels count with their stored value (0 in most files)
/// @return energy >= 0, 1/s, on the active voxels of `velocity`
/// @throws Failure naming the grid if its voxels are not cubes along the world's axes, or a value
///   is not finite
FloatGrid::Ptr vorticity_energy(const Ref<VectorGrid>& velocity, float gain);

}  // namespace fluidcarve
