#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of energy.*; each declaration says what the node does.

NodeType energy_combine();
NodeType energy_curvature();
NodeType energy_gradient();
NodeType energy_kinetic();
NodeType energy_remap();
NodeType energy_surface();
NodeType energy_volume();
NodeType energy_vorticity();

}  // namespace fluidcarve
