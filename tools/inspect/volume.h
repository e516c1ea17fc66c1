#pragma once

#include "tools/inspect/inspector.h"

namespace fluidcarve {

/// Inspector for .vdb files: grids, types, transforms, boxes, ranges and oddities. Reads the whole
/// file.
FileInspector vdb_inspector();

}  // namespace fluidcarve
