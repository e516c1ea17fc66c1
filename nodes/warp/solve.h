#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `warp.solve`: finds a warp (METHOD 11) of any amount, in place of seams.
NodeType warp_solve();

}  // namespace fluidcarve
