#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// Energy that is high where a field changes: gain |grad s|, by central differences (paper eq. 11,
/// third term).
/// @param field  any unit, with cubic voxels along the world's axes. Inactive voxels count with
///   their stored value
/// @return energy >= 0, units of `field` per world unit, on the active voxels of `field`
/// @throws Failure naming the grid if its voxels are not cubes along the world's axes, or a value
///   is not finite
FloatGrid::Ptr gradient_energy(const FloatGrid& field, float gain);

}  // namespace fluidcarve
