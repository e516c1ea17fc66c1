#pragma once

#include "graph/pipeline.h"

#include <vector>

namespace fluidcarve {

/// Passes promises of outputs (Declare::promises) to the nodes that take them, and so changes the
/// parameters of these nodes.
/// @param nodes  each after the nodes that it reads
void pass_promises(const std::vector<Node*>& nodes, Problems& problems);

}  // namespace fluidcarve
