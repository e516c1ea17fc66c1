#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of points.*; each declaration says what the node does.

NodeType points_keep_out();
NodeType points_read();
NodeType points_write();

}  // namespace fluidcarve
