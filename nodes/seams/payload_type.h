#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers `seams`.
void add_seams_payload(Registry& registry);

}  // namespace fluidcarve
