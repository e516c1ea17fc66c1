#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of image.*; each declaration says what the node does.

NodeType image_read();
NodeType image_write();

}  // namespace fluidcarve
