#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Inspector for `fluidcarve inspect FILE.vdb...`: grids, types, transforms, ranges and oddities. Reads the whole file.
FileInspector vdb_inspector();

}  // namespace fluidcarve
