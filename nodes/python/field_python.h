#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType field_python();

}  // namespace fluidcarve
