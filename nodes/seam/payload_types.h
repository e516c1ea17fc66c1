#pragma once

#include "graph/registry.h"

namespace fluidcarve {

/// Registers the payload types `lattice` and `seams`.
void add_lattice_payloads(Registry& registry);

}  // namespace fluidcarve
