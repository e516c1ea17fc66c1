#pragma once

#include "graph/registry.h"

namespace fluidcarve {

/// Registers the payload type `rig`.
void add_rig_payload(Registry& registry);

}  // namespace fluidcarve
