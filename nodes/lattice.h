#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of lattice.*; each declaration says what the node does.

NodeType lattice_around();
NodeType lattice_box();
NodeType lattice_build();
NodeType lattice_write();

}  // namespace fluidcarve
