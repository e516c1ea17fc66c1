#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// Curvature of a field's level surfaces, div (grad s / |grad s|) (paper eq. 8): the sum of the two principal curvatures, twice what OpenVDB
/// calls the mean curvature; of a ball 2 / radius, above 0 where `s` is a distance that grows outward. By central differences. The field
/// need not be a distance: multiples and monotone functions of one give the same.
/// Where a neighbour is not active the field is not known, and the curvature is 0: the end of a narrow band is no edge. Nor does it go beyond
/// that of a ball of one voxel's radius, the least that a grid shows: on ridges it would grow without end.
/// @param field  a level set or any field, in cubic voxels along the world's axes
/// @return 1 / world unit, on the active voxels of `field`
/// @throws Failure naming the grid if its voxels are no cubes or a value is not finite
FloatGrid::Ptr curvature_field(const FloatGrid& field);

NodeType field_curvature();

}  // namespace fluidcarve
