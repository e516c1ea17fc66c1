#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `rig.curve`: a rig from a file, or one per frame.
NodeType rig_curve();

}  // namespace fluidcarve
