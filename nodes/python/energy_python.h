#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType energy_python();

}  // namespace fluidcarve
