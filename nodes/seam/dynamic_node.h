#pragma once

#include "graph/registry.h"

namespace fluidcarve {

NodeType seam_dynamic();

}  // namespace fluidcarve
