#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `field.ax {inputs, params, code}`: a float field computed by a program in the pipeline
/// (expression.h).
NodeType field_ax();

}  // namespace fluidcarve
