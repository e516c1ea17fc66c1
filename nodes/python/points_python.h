#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType points_python();

}  // namespace fluidcarve
