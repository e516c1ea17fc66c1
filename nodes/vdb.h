#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of vdb.*; each declaration says what the node does.

NodeType vdb_read();
NodeType vdb_write();

}  // namespace fluidcarve
