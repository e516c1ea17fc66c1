#pragma once

#include "carve/points/point_image.h"
#include "carve/points/point_table.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

// All functions take openvdb::points::PointDataGrids.

/// Checks everything that the functions below rely on, since files may be damaged.
/// @throws Failure (input) naming the file, the grid and the fault: wrong counts, or more values
///   than the bytes can hold, no positions, a position that is not finite, attributes that differ
///   between leaves or have varying length
void require_sound(const openvdb::GridBase& grid, const std::string& path);

std::size_t point_count(const openvdb::GridBase& grid);
/// World positions, in the order of the leaves.
std::vector<openvdb::Vec3d> point_positions(const openvdb::GridBase& grid);
/// See Points::identities.
std::vector<std::uint64_t> point_identities(const openvdb::GridBase& grid);

/// See Points::has_ids.
bool has_point_ids(const openvdb::GridBase& grid);

/// with_images() of Points, for grids. Unchanged leaves share their data.
openvdb::GridBase::ConstPtr with_images(const openvdb::GridBase& grid,
                                        const std::vector<PointImage>& images,
                                        const openvdb::GridBase* more = nullptr);
/// alike() of Points, for grids.
bool alike(const openvdb::GridBase& a, const openvdb::GridBase& b);

/// Converts PLY vertices to a grid `points` in the same space. Its origin is at the centre of the
/// points, with about eight points per voxel of their bounding box. Positions become floats within
/// their voxel. Three properties `name_x`, `name_y`, `name_z` of one type become a vector.
/// Integers get the smallest type that holds their PLY type.
openvdb::GridBase::Ptr grid_of(const PointTable& points);

/// Converts points to PLY vertices in the grid's space: positions become doubles, vectors `name_x`,
/// `name_y`, `name_z`, groups 0 or 1 in `group_name`. Texts, matrices, quaternions and 64-bit
/// integers are left out, since PLY can't hold them.
/// @param left_out  receives the names of these attributes
PointTable ply_of(const openvdb::GridBase& grid, std::vector<std::string>& left_out);

}  // namespace fluidcarve
