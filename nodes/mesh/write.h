#pragma once

#include "graph/node_type.h"

namespace fluidcarve {

NodeType mesh_write();

}  // namespace fluidcarve
