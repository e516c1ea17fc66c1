#pragma once

#include "graph/registry.h"

namespace fluidcarve {

NodeType seam_graph_cut();

}  // namespace fluidcarve
