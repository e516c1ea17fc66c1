#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// Registers the payload type `points`, and its conversion to a volume with one point grid.
void add_points_payload(Registry& registry);

}  // namespace fluidcarve
