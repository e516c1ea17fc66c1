#pragma once

#include <cstddef>
#include <optional>

namespace fluidcarve {

/// The index from 0 of an entry of an OBJ file, such as a vertex.
/// @param stated  in the file: counted from 1, or backwards from the last entry if negative
/// @param size    number of entries so far
/// @return nothing for 0 and before the first entry; beyond `size` for an entry that follows later
inline std::optional<std::size_t> obj_index(long stated, std::size_t size) {
    if (stated > 0) return static_cast<std::size_t>(stated) - 1;
    const auto back = std::size_t{0} - static_cast<std::size_t>(stated);
    return stated == 0 || back > size ? std::nullopt : std::optional(size - back);
}

}  // namespace fluidcarve
