#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of filter.*; each declaration says what the node does.

NodeType filter_seam();

}  // namespace fluidcarve
