#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of warp.*; each declaration says what the node does.

NodeType warp_solve();

}  // namespace fluidcarve
