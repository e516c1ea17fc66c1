#pragma once

#include <openvdb/Types.h>

#include <string>
#include <vector>

namespace fluidcarve {

/// The points of a curve, in the file's units; of a line that returns to its first point, that one again at the end.
///
///   .obj  the one line that all `l` elements make up, in whatever pieces and order; it runs as the first of them
///   .ply  ascii; all points of the element `vertex`, in order
///   .csv  a point per line: columns `x`, `y` and `z` of a header, else the first three; separated by commas,
///         semicolons or blanks; empty lines and what follows a # are skipped
///
/// @throws Failure (input) naming file and line if it can't be read, or is none of these, or holds no such line
std::vector<openvdb::Vec3d> read_curve(const std::string& path);

}  // namespace fluidcarve
