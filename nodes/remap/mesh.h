#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType remap_mesh();

}  // namespace fluidcarve
