#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

/// All built-in node types and payload types.
Registry builtin_registry();

}  // namespace fluidcarve
