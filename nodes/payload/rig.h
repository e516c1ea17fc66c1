#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers the payload type `rig`.
void add_rig_payload(Registry& registry);

}  // namespace fluidcarve
