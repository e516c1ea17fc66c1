#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `points.read {path, grid, missing, offset}`: reads the points of a VDB or PLY file.
NodeType points_read();

}  // namespace fluidcarve
