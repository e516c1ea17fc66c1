#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `usd.write {volumes, path, files}`: writes one .usda file that holds a shot together: its .vdb files, and .usda files of meshes and points.
NodeType usd_write();

}  // namespace fluidcarve
