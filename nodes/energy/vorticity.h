#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// Energy that is high where the flow spins: gain |curl v|, by central differences (paper eq. 11, first term).
/// @param velocity  world units per second, in cubic voxels along the world's axes; a staggered grid is collocated first.
///                  Beyond its active voxels the values that it holds count (0, in most files)
/// @return energy >= 0, 1/s, on the active voxels of `velocity`
/// @throws Failure naming the grid if its voxels are no cubes or a value is not finite
FloatGrid::Ptr vorticity_energy(const Ref<VectorGrid>& velocity, float gain);

NodeType energy_vorticity();

}  // namespace fluidcarve
