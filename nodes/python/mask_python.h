#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType mask_python();

}  // namespace fluidcarve
