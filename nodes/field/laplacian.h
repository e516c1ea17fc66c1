#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// div grad of a field, by the differences to the six neighbours: below 0 on peaks, above 0 in pits.
/// @param field  any unit, in cubic voxels along the world's axes. Beyond its active voxels the values that it holds count
/// @return units of `field` per square world unit, on the active voxels of `field`
/// @throws Failure naming the grid if its voxels are no cubes or a value is not finite
FloatGrid::Ptr laplacian_field(const FloatGrid& field);

NodeType field_laplacian();

}  // namespace fluidcarve
