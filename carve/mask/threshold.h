#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// The active voxels of a field with a value in `[low, high]`.
/// @param field  any unit; NaN is in no range
/// @return a mask with the field's transform
MaskGrid::Ptr threshold_mask(const FloatGrid& field, double low, double high);

}  // namespace fluidcarve
