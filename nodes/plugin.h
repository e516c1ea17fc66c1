#pragma once

#include "graph/types/node_type.h"
#include "graph/types/plugin.h"
#include "nodes/grid_instances.h"
#include "nodes/payloads.h"

/// All that a plugin of nodes on grids includes: declarations of nodes, the plugin's entry, grids and volumes.
/// A plugin with a solver includes nodes/seam/solver.h, too.
