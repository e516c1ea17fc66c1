#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of seam.*; each declaration says what the node does.

NodeType seam_dynamic();
NodeType seam_graph_cut();
NodeType seam_greedy();
NodeType seam_pyramid();

}  // namespace fluidcarve
