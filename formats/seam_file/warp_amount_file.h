#pragma once

#include "carve/warp/amount.h"

#include <string>

namespace fluidcarve {

/// Reads the amounts of a warp from a CSV file. Its first line names the columns: `amount`, and
/// `w`, `time` or both; each further line is a point of the curve. Amounts and places are those of
/// WarpAmount: a number of vertices or a percentage; 0 to 1 along w; frame numbers. Points rise.
/// With both columns each frame that the file names has a curve of its own along w: the lines of a
/// frame stand together, and frames rise. Lines are those of FileText::next_cells(); other columns
/// are skipped.
/// @throws Failure (input) naming file and line if the file can't be read, is larger than 64 MiB,
///   has another form, or holds no point
WarpAmount read_amounts(const std::string& path);

}  // namespace fluidcarve
