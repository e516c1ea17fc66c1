#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// `seam.graph_cut`: exact seams by a minimum cut through all vertices.
NodeType seam_graph_cut();

}  // namespace fluidcarve
