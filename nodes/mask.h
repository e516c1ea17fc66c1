#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of mask.*; each declaration says what the node does.

NodeType mask_below_surface();
NodeType mask_box();
NodeType mask_combine();
NodeType mask_dilate();
NodeType mask_mesh();
NodeType mask_sphere();
NodeType mask_threshold();
NodeType mask_weight();

}  // namespace fluidcarve
