#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// The gradient of a field, by central differences.
/// @param field  any unit, with cubic voxels along the world's axes. Inactive voxels count with
///   their stored value
/// @return units of `field` per world unit, on the active voxels of `field`
/// @throws Failure naming the grid if its voxels are not cubes along the world's axes, or a value
///   is not finite
VectorGrid::Ptr gradient_field(const FloatGrid& field);

}  // namespace fluidcarve
