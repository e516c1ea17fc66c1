#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace fluidcarve {

/// For grids that are combined voxel by voxel.
/// @param what  the two, as the message calls them: "terms 1 and 2"
/// @throws Failure naming both grids, their voxel sizes and where they start, if their transforms differ
void require_same_transform(const std::string& what, const openvdb::GridBase& first, const openvdb::GridBase& second);

}  // namespace fluidcarve
