#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

NodeType rig_python();

}  // namespace fluidcarve
