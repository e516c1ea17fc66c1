#pragma once

#include "graph/text/value.h"

#include <memory>

namespace fluidcarve {

/// Reads YAML text into a Value with places. Safe on hostile text: at most 1 MiB, 64 levels, and 100 000 values after aliases are
/// expanded. Duplicate keys, recursive aliases and non-scalar keys are problems.
/// @return null if a problem was added
Value read_yaml(const std::shared_ptr<const Source>& source, Problems& problems);

}  // namespace fluidcarve
