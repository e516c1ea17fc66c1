#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of rig.*; each declaration says what the node does.

NodeType rig_advect();
NodeType rig_circle();
NodeType rig_curve();
NodeType rig_points();
NodeType rig_transform();

}  // namespace fluidcarve
