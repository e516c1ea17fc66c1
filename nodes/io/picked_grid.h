#pragma once

#include "graph/types/registry.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// "has no grid 'x'; it has density, vel": the end of a message.
/// @param known    the names that are there
/// @param because  who wants it: ", but 'edges' takes carved.x"
std::string lacks_grid(const std::string& name, const std::vector<std::string>& known, const std::string& because = {});

/// Registers how inputs take one grid of a volume by its name, `node.name` (Selection): as a float grid, a vector grid, any grid, or a volume
/// of its own. A vector `vel` is also made of three float grids `vel.x`, `vel.y` and `vel.z`; of several grids of one name it is the first.
void add_grid_selections(Registry& registry);

}  // namespace fluidcarve
