#pragma once

#include "nodes/payloads.h"
#include "nodes/points/points.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// Where a file's points are against its grids, which the file does not say.
enum class PointOffset {
    detect,      ///< by whose file it is (profile.h)
    none,        ///< where the file says
    half_voxel,  ///< half a voxel below, along each axis: Blender's liquids
};

/// Reads a PLY file, known by its first bytes, or one point grid of a VDB file; no other grid is read.
/// @param grid  its name; empty: the only one that there is
/// @throws Failure (input) as read_ply, read_vdb_grid and require_sound; if there is no point grid, or several and no name
Points read_points(const std::string& path, const std::string& grid, PointOffset offset, const Placement& placement);

/// What can be known without reading the points themselves: that the file is whole and holds some.
/// @throws Failure (input) as read_points, but for what is wrong with the points
void look_at_points(const std::string& path, const std::string& grid);

/// The points as a grid in the shot's world, which remembers its placement.
openvdb::GridBase::ConstPtr in_grid(const Points& points);

/// What a file that was written does not say.
struct Unsaid {
    std::vector<std::string> attributes;  ///< names of those that PLY can't hold, and that stayed behind
    std::string offset;                   ///< what points.read must be told as `offset` to find the points where they are; empty: nothing
};

/// Writes a PLY file if the path ends in .ply, else a VDB file; placements are undone, but that a PLY file knows no voxels, and has the points
/// where they are against the grids. The file appears whole or not at all.
/// @param beside     further grids for a VDB file. A point grid of the points' name gives its place to them, otherwise they come last; what
///                   it says of its file and codec goes before what the points say
/// @param encoding   of a PLY file; null: as it was read, little-endian if it was none
/// @param placement  what to undo instead, as for write_vdb
/// @throws Failure if the file can't be written, or if several point grids of `beside` have the points' name
Unsaid write_points(const std::string& path, const Points& points, const Volume* beside, const PlyEncoding* encoding, const Placement* placement);

/// Whether a path ends as PLY files' do.
bool names_ply(const std::string& path);

}  // namespace fluidcarve
