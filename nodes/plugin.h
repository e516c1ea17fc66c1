#pragma once

#include "graph/types/node_type.h"
#include "graph/types/plugin.h"
#include "nodes/grid_instances.h"
#include "nodes/payloads.h"

// The header for plugins: declarations of nodes, the plugin's entry points, grids and volumes.
// A plugin with a solver also includes nodes/seam/solver.h.
