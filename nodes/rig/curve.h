#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `rig.curve`: a rig from a file, or one per frame from a sequence of files.
NodeType rig_curve();

}  // namespace fluidcarve
