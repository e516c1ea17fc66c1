#pragma once

#include "carve/volume/volume.h"

#include <set>
#include <string>
#include <vector>

namespace fluidcarve {

/// "has no grid 'x'; it has density, vel": the end of a message.
/// @param known    the names that are there
/// @param because  why it is needed: ", but 'edges' takes carved.x"
std::string lacks_grid(const std::string& name, const std::vector<std::string>& known,
                       const std::string& because = {});

/// The grids of a volume that have one of some names.
/// @param names  names, or patterns with * and ?
/// @throws Failure naming a name or pattern that no grid has
std::set<const openvdb::GridBase*> grids_named(const Volume& volume,
                                               const std::vector<std::string>& names);

/// The grids of some names, or all others; in their order.
/// @param names  names, or patterns with * and ?
/// @param keep   whether the named ones stay, or go
/// @throws Failure naming a name or pattern that no grid has
Volume picked(const Volume& volume, const std::vector<std::string>& names, bool keep);

}  // namespace fluidcarve
