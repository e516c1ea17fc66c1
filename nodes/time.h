#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of time.*; each declaration says what the node does.

NodeType time_loop();
NodeType time_loop_mesh();
NodeType time_loop_points();
NodeType time_retime();
NodeType time_retime_mesh();
NodeType time_retime_points();

}  // namespace fluidcarve
