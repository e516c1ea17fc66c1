#pragma once

#include "tools/compare/file_comparer.h"

namespace fluidcarve {

/// Compares the grids of .vdb files, by their names. Only two grids are in memory at once.
FileComparer volume_comparer();

/// Compares the channels of images, pixel by pixel, as image.read gives them: upright, integers
/// from 0 to 1.
FileComparer image_comparer();

/// Compares meshes, points and curves: positions one by one, in the order of the files; of meshes
/// the faces, too, and the names of the attributes.
FileComparer geometry_comparer();

/// All of them.
const std::vector<FileComparer>& comparers();

}  // namespace fluidcarve
