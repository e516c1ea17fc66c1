#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers how inputs take one grid of a volume by its name, `node.name` (Selection): as a float
/// grid, a vector grid, any grid, or a volume of its own. A vector `vel` is also made of three
/// float grids `vel.x`, `vel.y` and `vel.z`; of several grids of one name it is the first.
void add_grid_selections(Registry& registry);

}  // namespace fluidcarve
