#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `lattice.box`: a straight lattice, given by its corners or fitted to the active voxels of a sequence.
NodeType lattice_box();

}  // namespace fluidcarve
