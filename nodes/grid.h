#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of grid.*; each declaration says what the node does.

NodeType grid_crop();
NodeType grid_pick();
NodeType grid_prune();
NodeType grid_resample();

}  // namespace fluidcarve
