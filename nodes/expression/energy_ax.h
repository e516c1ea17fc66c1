#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `energy.ax {inputs, params, code}`: an energy by a program that stands in the pipeline (expression.h).
NodeType energy_ax();

}  // namespace fluidcarve
