#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of usd.*; each declaration says what the node does.

NodeType usd_write();

}  // namespace fluidcarve
