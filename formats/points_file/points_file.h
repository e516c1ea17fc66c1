#pragma once

#include "carve/points/points.h"
#include "carve/volume/volume.h"
#include "formats/file/provenance.h"
#include "formats/points_file/point_losses.h"

#include <string>

namespace fluidcarve {

/// Offset of a file's points relative to its grids; the file does not state it.
enum class PointOffset {
    detect,      ///< that of the application that wrote the file (conventions.h)
    none,        ///< positions as in the file
    half_voxel,  ///< half a voxel lower along each axis, as in Blender's liquids
};

/// Reads a PLY file, recognised by its first bytes, or one point grid of a VDB file.
/// @param grid  name of the point grid; empty: the only one
/// @throws Failure (input) as read_ply, VdbFile and require_sound; if there is no point grid, or
///   several and no name
Points read_points(const std::string& path, const std::string& grid, PointOffset offset,
                   const Placement& placement);

/// Checks without reading the points that a file is complete and holds points.
/// @throws Failure (input) as read_points, except for faults of the points themselves
void probe_points(const std::string& path, const std::string& grid);

/// Writes a PLY file if the path ends in .ply, else a VDB file. Undoes the placement; in a PLY file
/// the half-voxel offset stays, since PLY has no voxels. The file appears whole or not at all.
/// @param beside     further grids for a VDB file, or null. The points replace a point grid of the
///   same name, else they come last. Its metadata and codec have precedence over those of the
///   points
/// @param encoding   for a PLY file; null: as it was read, or little-endian
/// @param placement  the placement to undo; null: that of the reader
/// @param provenance  what the file states of how it was made
/// @throws Failure if the file can't be written, or if several point grids of `beside` have the
///   points' name
PointLosses write_points(const std::string& path, const Points& points, const Volume* beside,
                         const NumberForm* encoding, const Placement* placement,
                         const Provenance& provenance = {});

}  // namespace fluidcarve
