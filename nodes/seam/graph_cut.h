#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

NodeType seam_graph_cut();

}  // namespace fluidcarve
