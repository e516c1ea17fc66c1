#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types *.python. Each declaration says what the node does.

NodeType energy_python();
NodeType field_python();
NodeType mask_python();
NodeType points_python();
NodeType rig_python();
NodeType seam_python();

}  // namespace fluidcarve
