#pragma once

#include "graph/pipeline.h"

#include <vector>

namespace fluidcarve {

/// Tells nodes what the outputs that they take promise (Declare::promises), and so changes their
/// parameters.
/// @param nodes  each behind those that it reads
void pass_promises(const std::vector<Node*>& nodes, Problems& problems);

}  // namespace fluidcarve
