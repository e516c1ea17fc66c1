#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `lattice.box`: a straight lattice from its corners, or around the active voxels of a sequence.
NodeType lattice_box();

}  // namespace fluidcarve
