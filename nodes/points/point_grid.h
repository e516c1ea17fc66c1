#pragma once

#include "nodes/points/ply.h"
#include "nodes/points/point_image.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

// All grids below are point grids.

/// Looks at all that the functions below rely on, as a file may hold anything.
/// @throws Failure (input) naming the file and the grid: counts that don't fit, or far beyond what so many bytes can hold, no positions, one
///   that is not finite, attributes that differ from leaf to leaf or that are of varying length
void require_sound(const openvdb::GridBase& grid, const std::string& path);

std::size_t point_count(const openvdb::GridBase& grid);
/// World positions, leaf by leaf.
std::vector<openvdb::Vec3d> point_positions(const openvdb::GridBase& grid);
/// As Points::identities.
std::vector<std::uint64_t> point_identities(const openvdb::GridBase& grid);

/// As for Points. Leaves whose points all stay are shared.
openvdb::GridBase::ConstPtr with_images(const openvdb::GridBase& grid, const std::vector<PointImage>& images);

/// The vertices as a grid `points` in the same space, with about eight points to a voxel of the box around them, in whose middle the
/// grid's origin is: positions as floats within their voxel, three properties `name_x`, `name_y`, `name_z` of one type as a vector, whole
/// numbers in the least type that holds them all.
openvdb::GridBase::Ptr grid_of(const PlyPoints& points);

/// The points as vertices in the grid's space: positions as doubles, vectors as `name_x`, `name_y`, `name_z`, groups as 0 or 1 in
/// `group_name`. PLY holds neither texts, matrices and quaternions nor whole numbers of 64 bits: those stay behind.
/// @param left_out  becomes the names of attributes that PLY can't hold
PlyPoints ply_of(const openvdb::GridBase& grid, std::vector<std::string>& left_out);

}  // namespace fluidcarve
