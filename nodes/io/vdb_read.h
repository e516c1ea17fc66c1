#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `vdb.read {path, grids, missing}`: all grids of a .vdb file, and those named in `grids` as typed outputs.
/// If nothing wants the whole volume, only the named grids are read; if something does, they are the volume's own.
NodeType vdb_read();

}  // namespace fluidcarve
