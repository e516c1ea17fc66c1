#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `points.write {source, path, beside}`: points to a VDB or PLY file, in a VDB file with other grids beside them.
NodeType points_write();

}  // namespace fluidcarve
