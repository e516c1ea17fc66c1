#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `remap.grids {source, lattice, seams, count, interpolation}`: carves seams from, or inserts them into, a volume.
NodeType remap_grids();

}  // namespace fluidcarve
