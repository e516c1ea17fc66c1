#pragma once

#include "graph/registry.h"

namespace fluidcarve {

NodeType seam_pyramid();

}  // namespace fluidcarve
