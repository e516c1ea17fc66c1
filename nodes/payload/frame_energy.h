#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers the payload type `frame_energy`. Register `lattice` before.
void add_frame_energy_payload(Registry& registry);

}  // namespace fluidcarve
