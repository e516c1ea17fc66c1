#pragma once

#include "graph/node_type.h"

namespace fluidcarve {

/// `seam.greedy`: the paper's multi-greedy search (greedy_seam).
NodeType seam_greedy();

}  // namespace fluidcarve
