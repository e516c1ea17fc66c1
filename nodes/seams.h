#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of seams.*; each declaration says what the node does.

NodeType seams_choose();
NodeType seams_curves();
NodeType seams_read();
NodeType seams_write();

}  // namespace fluidcarve
