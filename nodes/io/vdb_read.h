#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `vdb.read {path, grids, missing}`: reads all grids of a .vdb file, with those named in `grids` as typed outputs.
/// If no node reads the whole volume, only the named grids are read from the file.
NodeType vdb_read();

}  // namespace fluidcarve
