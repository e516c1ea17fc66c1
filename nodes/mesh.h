#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of mesh.*; each declaration says what the node does.

NodeType mesh_read();
NodeType mesh_write();

}  // namespace fluidcarve
