#pragma once

#include "carve/volume/grid_instances.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "graph/types/plugin.h"

// The header for plugins: declarations of nodes, the plugin's entry points, grids and volumes.
// A plugin with a solver also includes nodes/solving/solver.h.
