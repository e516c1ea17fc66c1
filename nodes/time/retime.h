#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// A sequence, faster, slower, backwards, or along a curve.
NodeType time_retime();

}  // namespace fluidcarve
