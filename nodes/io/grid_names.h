#pragma once

#include "nodes/payloads.h"

#include <set>
#include <string>
#include <vector>

namespace fluidcarve {

/// The grids of a volume that have one of some names.
/// @param names  names, or patterns with * and ?
/// @throws Failure naming a name or pattern that no grid has
std::set<const openvdb::GridBase*> grids_named(const Volume& volume, const std::vector<std::string>& names);

}  // namespace fluidcarve
