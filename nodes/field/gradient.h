#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// Where and how steeply a field rises, by central differences.
/// @param field  any unit, in cubic voxels along the world's axes. Beyond its active voxels the values that it holds count
/// @return units of `field` per world unit, on the active voxels of `field`
/// @throws Failure naming the grid if its voxels are no cubes or a value is not finite
VectorGrid::Ptr gradient_field(const FloatGrid& field);

NodeType field_gradient();

}  // namespace fluidcarve
