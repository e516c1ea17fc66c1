#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers `float`, `vector`, `mask`, `grid` and `volume`, and what converts to what: any grid to a volume of one.
void add_payloads(Registry& registry);

}  // namespace fluidcarve
