#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers the payload type `seams`.
void add_seams_payload(Registry& registry);

}  // namespace fluidcarve
