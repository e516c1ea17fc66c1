#pragma once

#include "tools/compare/file_comparer.h"

namespace fluidcarve {

/// All comparers of files:
/// - of the grids of .vdb files, by their names; only two grids are in memory at once
/// - of the channels of images, pixel by pixel, as image.read gives them: upright, integers from 0
///   to 1
/// - of meshes, points and curves: positions one by one, in the order of the files; of meshes the
///   faces, too, and the names of the attributes
const std::vector<FileComparer>& comparers();

}  // namespace fluidcarve
