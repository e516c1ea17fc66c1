#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `lattice.around`: builds a lattice around a rig, or one per frame around a moving rig.
NodeType lattice_around();

}  // namespace fluidcarve
