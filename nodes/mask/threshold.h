#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// The active voxels of a field whose value lies in `[low, high]`.
/// @param field  any unit; a NaN lies nowhere
/// @return a mask with the field's transform
MaskGrid::Ptr threshold_mask(const FloatGrid& field, double low, double high);

NodeType mask_threshold();

}  // namespace fluidcarve
