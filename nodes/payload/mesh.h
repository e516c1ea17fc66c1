#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers the payload type `mesh`.
void add_mesh_payload(Registry& registry);

}  // namespace fluidcarve
