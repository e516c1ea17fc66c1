#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `seams.read {path}`: reads seams that `seams.write` wrote.
NodeType seams_read();

}  // namespace fluidcarve
