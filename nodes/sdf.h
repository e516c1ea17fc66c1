#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of sdf.*; each declaration says what the node does.

NodeType sdf_from_mesh();
NodeType sdf_from_points();
NodeType sdf_to_mesh();

}  // namespace fluidcarve
