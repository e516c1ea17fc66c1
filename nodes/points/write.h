#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `points.write {source, path, beside}`: writes points to a PLY file, or to a VDB file, perhaps with other grids.
NodeType points_write();

}  // namespace fluidcarve
