#pragma once

#include "carve/volume/volume.h"
#include "graph/types/payload.h"

// What nodes hand on: shared grids and volumes.
