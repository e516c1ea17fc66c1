#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `remap.points {source, lattice, seams, count, rim}`: carves seams from, or inserts them into, a list of points (METHOD 6).
NodeType remap_points();

}  // namespace fluidcarve
