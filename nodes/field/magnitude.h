#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// The length of each vector.
/// @param vectors  any unit; a staggered grid is collocated first
/// @return the same unit, on the active voxels of `vectors`; the background is that of `vectors`, as a length
/// @throws Failure naming the grid and voxel if a value is not finite
FloatGrid::Ptr magnitude_field(const Ref<VectorGrid>& vectors);

NodeType field_magnitude();

}  // namespace fluidcarve
