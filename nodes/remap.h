#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of remap.*; each declaration says what the node does.

NodeType remap_grids();
NodeType remap_mesh();
NodeType remap_points();

}  // namespace fluidcarve
