#pragma once

#include "graph/types/node_type.h"

namespace fluidcarve {

/// `vdb.write {source, path, compression}`: writes a volume or one grid to a .vdb file, which appears whole or not at all.
NodeType vdb_write();

}  // namespace fluidcarve
