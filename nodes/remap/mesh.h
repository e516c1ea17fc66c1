#pragma once

#include "graph/node_type.h"

namespace fluidcarve {

NodeType remap_mesh();

}  // namespace fluidcarve
