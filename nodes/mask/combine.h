#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

#include <vector>

namespace fluidcarve {

/// How masks are combined.
enum class MaskMode {
    any,    ///< union: voxels in any of the masks
    all,    ///< intersection: voxels in all masks
    first,  ///< difference: voxels in the first mask and in no other
};

/// Combines masks to one.
/// @param masks  at least one, all with the same transform
/// @throws Failure naming two masks with different transforms
MaskGrid::Ptr combined_mask(const std::vector<Ref<MaskGrid>>& masks, MaskMode mode);

NodeType mask_combine();

}  // namespace fluidcarve
