#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `field.ax {inputs, params, code}`: a field of numbers by a program that stands in the pipeline (expression.h).
NodeType field_ax();

}  // namespace fluidcarve
