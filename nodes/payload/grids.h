#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers the payload types `float`, `vector`, `mask`, `grid` and `volume`, and their
/// conversions: each grid type to `grid` and to a volume with one grid.
void add_grid_payloads(Registry& registry);

}  // namespace fluidcarve
