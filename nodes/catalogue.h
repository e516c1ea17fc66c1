#pragma once

#include "graph/registry.h"

namespace fluidcarve {

/// All built-in node types and payload types.
Registry builtin_registry();

}  // namespace fluidcarve
