#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers the payload types `lattice` and `active_box`. A fitted lattice keeps one active box
/// per frame.
void add_lattice_payloads(Registry& registry);

}  // namespace fluidcarve
