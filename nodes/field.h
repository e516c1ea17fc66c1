#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

// The node types of field.*; each declaration says what the node does.

NodeType field_collocate();
NodeType field_curl();
NodeType field_curvature();
NodeType field_filter();
NodeType field_gradient();
NodeType field_laplacian();
NodeType field_magnitude();

}  // namespace fluidcarve
