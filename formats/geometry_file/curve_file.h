#pragma once

#include <openvdb/Types.h>

#include <string>
#include <vector>

namespace fluidcarve {

/// Reads the points of a curve. A line that returns to its first point has that point again at the
/// end.
///
///   .obj  the one line that all `l` elements make up, in any pieces and order; it runs in the
///         direction of the first
///   .ply  ascii; all points of the element `vertex`, in order
///   .csv  a point per line: columns `x`, `y` and `z` of the header, else the first three columns;
///         separated by commas, semicolons or blanks; empty lines and text behind a # are skipped
///
/// @return in the file's units
/// @throws Failure (input) naming file and line if the file can't be read, is larger than 64 MiB,
///   has another format, or holds no such line
std::vector<openvdb::Vec3d> read_curve(const std::string& path);

}  // namespace fluidcarve
