#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `lattice.build`: builds a lattice along a rig, or one per frame along a moving rig.
NodeType lattice_build();

}  // namespace fluidcarve
