#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `energy.ax {inputs, params, code}`: an energy computed by a program in the pipeline
/// (expression.h).
NodeType energy_ax();

}  // namespace fluidcarve
