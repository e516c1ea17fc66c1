#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// Curvature of a field's level surfaces, div (grad s / |grad s|) (paper eq. 8), by central
/// differences. It is the sum of the two principal curvatures, twice OpenVDB's mean curvature: 2 /
/// radius for a ball whose distance `s` grows outward. The field need not be a distance: multiples
/// and rising functions of a distance give the same curvature.
/// Where a neighbour is inactive, the field is unknown and the curvature is 0, so that the end of a
/// narrow band does not count as an edge. The magnitude is limited to that of a ball with a radius
/// of one voxel, the smallest that a grid resolves; on ridges it would be infinite.
/// @param field  a level set or any field, with cubic voxels along the world's axes
/// @return 1 / world unit, on the active voxels of `field`
/// @throws Failure naming the grid if its voxels are not cubes along the world's axes, or a value
///   is not finite
FloatGrid::Ptr curvature_field(const FloatGrid& field);

}  // namespace fluidcarve
