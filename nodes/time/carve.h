#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// A sequence that is some frames shorter or longer.
NodeType time_carve();

}  // namespace fluidcarve
