#pragma once

#include "carve/points/point_table.h"
#include "formats/geometry_file/ply.h"

#include <openvdb/Types.h>

#include <string>

namespace fluidcarve {

/// Whether a file begins like a PLY file. @throws Failure (input) if it can't be read
bool is_ply(const std::string& path);

/// Whether the header of a PLY file declares vertices alone, as read_ply takes them: no faces.
bool holds_points(const std::string& path);

/// Reads a PLY file.
/// @throws Failure (input) naming the file and the fault: not a PLY file, truncated, no x, y and z
///   of floats, a position that is not finite, lists at vertices, or other elements with entries,
///   such as faces, which refer to vertices
PointTable read_ply(const std::string& path);

/// Reads only the header; the columns stay empty. Checks the file's length.
/// @throws Failure as read_ply, for the header
PointTable read_ply_header(const std::string& path);

/// Writes a PLY file. It appears whole or not at all. Numbers in ascii files are the shortest that
/// read back exactly.
/// @throws Failure if the file can't be written
void write_ply(const std::string& path, const PointTable& points);

}  // namespace fluidcarve
