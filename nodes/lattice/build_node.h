#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `lattice.build`: a lattice along a rig, or one per frame along a rig that moves.
NodeType lattice_build();

}  // namespace fluidcarve
