#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

#include <vector>

namespace fluidcarve {

enum class MaskMode {
    any,    ///< union: what is in any of the masks
    all,    ///< intersection: what is in all of them
    first,  ///< difference: what is in the first and in no other
};

/// @param masks  at least one, all of one transform
/// @throws Failure naming two masks whose transforms differ
MaskGrid::Ptr combined_mask(const std::vector<Ref<MaskGrid>>& masks, MaskMode mode);

NodeType mask_combine();

}  // namespace fluidcarve
