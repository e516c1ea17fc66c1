#pragma once

#include "graph/registry.h"

namespace fluidcarve {

/// Registers `lattice` and `seams`, and what is kept of frames for them: `frame_energy`, `active_box`.
void add_lattice_payloads(Registry& registry);

}  // namespace fluidcarve
