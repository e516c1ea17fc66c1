#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// The Laplacian of a field, div grad, by differences to the six neighbours: below 0 on peaks,
/// above 0 in pits.
/// @param field  any unit, with cubic voxels along the world's axes. Inactive voxels count with
///   their stored value
/// @return units of `field` per square world unit, on the active voxels of `field`
/// @throws Failure naming the grid if its voxels are not cubes along the world's axes, or a value
///   is not finite
FloatGrid::Ptr laplacian_field(const FloatGrid& field);

}  // namespace fluidcarve
