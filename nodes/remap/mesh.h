#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `remap.mesh {source, lattice, seams, count, rim, static}`: carves a mesh.
NodeType remap_mesh();

}  // namespace fluidcarve
