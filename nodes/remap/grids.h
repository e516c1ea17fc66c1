#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `remap.grids {source, lattice, seams, count, interpolation}`: carves seams from the grids of a volume, or inserts them.
NodeType remap_grids();

}  // namespace fluidcarve
