#pragma once

#include "carve/solver/task/params.h"
#include "graph/types/node_check.h"

namespace fluidcarve {

/// Finds parameters that do not go together, and such that want an input or are at odds with one.
void check_params(const SolverParams& params, NodeCheck& check);

}  // namespace fluidcarve
