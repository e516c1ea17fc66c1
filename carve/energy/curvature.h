#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// Energy that is high where a surface curves: gain |H|, with `H` the sum of the principal
/// curvatures (paper eq. 7 and 8, first term).
/// @param surface  a level set, or any field: its level surfaces count, as for curvature_field
/// @return energy >= 0, 1 / world unit, on the active voxels of `surface`
/// @throws Failure as curvature_field
FloatGrid::Ptr curvature_energy(const FloatGrid& surface, float gain);

}  // namespace fluidcarve
