#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// The grids of some names, or all others; in their order.
/// @param names  names, or patterns with * and ?
/// @param keep   whether the named ones stay, or go
/// @throws Failure naming a name or pattern that no grid has
Volume picked(const Volume& volume, const std::vector<std::string>& names, bool keep);

NodeType grid_pick();

}  // namespace fluidcarve
