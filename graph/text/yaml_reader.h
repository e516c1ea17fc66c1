#pragma once

#include "graph/text/text_room.h"
#include "graph/text/value.h"

#include <cstddef>
#include <memory>

namespace fluidcarve {

/// The longest text that read_yaml accepts, bytes.
constexpr std::size_t most_yaml_bytes = std::size_t{1} << 20;

/// Reads YAML text into a Value with places. Safe on hostile text: at most most_yaml_bytes, 64
/// levels, and 100 000 values and as much text as there is room for after aliases are expanded.
/// Duplicate keys, recursive aliases and non-scalar keys are problems.
/// @return null if a problem was added
Value read_yaml(const std::shared_ptr<const Source>& source, Problems& problems, TextRoom& room);
inline Value read_yaml(const std::shared_ptr<const Source>& source, Problems& problems) {
    TextRoom room;
    return read_yaml(source, problems, room);
}

}  // namespace fluidcarve
