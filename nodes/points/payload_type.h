#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers the payload type `points`; it converts to a volume with their grid.
void add_points_payload(Registry& registry);

}  // namespace fluidcarve
