#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// Energy that is high where the flow is fast: gain u . u (paper eq. 10, second term).
/// @param velocity  world units per second; a staggered grid is collocated first
/// @return energy >= 0, squared units of `velocity`, on its active voxels
/// @throws Failure naming the grid and the voxel if a value is not finite
FloatGrid::Ptr kinetic_energy(const Ref<VectorGrid>& velocity, float gain);

}  // namespace fluidcarve
