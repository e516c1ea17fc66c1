#pragma once

#include "graph/text/value.h"

#include <memory>

namespace fluidcarve {

/// YAML text to a Value with places. Safe on hostile text: at most 1 MiB, 64 levels, 100 000 values with aliases
/// followed; duplicate keys, aliases into themselves and non-scalar keys are problems.
/// @return a null value if a problem was added
Value read_yaml(const std::shared_ptr<const Source>& source, Problems& problems);

}  // namespace fluidcarve
