#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType seam_python();

}  // namespace fluidcarve
