#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType mesh_read();

}  // namespace fluidcarve
