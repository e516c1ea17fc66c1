#pragma once

#include "carve/stream/tree_bytes.h"

#include <openvdb/Grid.h>

#include <span>
#include <vector>

namespace fluidcarve {

/// Checks the buffers of a tree of points (as check_tree). OpenVDB reads them in passes over all
/// leaves: sizes of voxel buffers; attributes' names, types and lengths; lengths of pages; offsets
/// in voxels; pages.
/// @param in      at the first byte of the buffers; moves behind them
/// @param leaves  value masks of the leaves, in the order in which they are read
/// @throws std::runtime_error
void check_points(TreeBytes& in, const std::vector<std::span<const char>>& leaves);

/// Checks that the points of each voxel lie within the attributes; a grid of another type is left
/// alone.
/// @throws openvdb::Exception
void check_offsets(const openvdb::GridBase& grid);

}  // namespace fluidcarve
