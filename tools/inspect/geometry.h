#pragma once

#include "tools/inspect/inspector.h"

namespace fluidcarve {

/// Inspector for meshes (.obj, .ply, .off, .stl), points (.ply without faces) and curves (.csv, and
/// .obj with lines alone): counts, attributes, the box in the world, and what of the file is not
/// read. Reads the whole file.
FileInspector geometry_inspector();

}  // namespace fluidcarve
