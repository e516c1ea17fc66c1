#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// `fluidcarve inspect FILE.vdb...`: grids, types, transforms, ranges, and what surprises in such files. Reads all of a file.
FileInspector vdb_inspector();

}  // namespace fluidcarve
