#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers `lattice`, and `active_box`, which is kept of each frame for lattices that fit.
void add_lattice_payloads(Registry& registry);

}  // namespace fluidcarve
