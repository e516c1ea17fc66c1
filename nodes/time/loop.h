#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// The part of a sequence that closes best, as a loop.
NodeType time_loop();

}  // namespace fluidcarve
