#include "nodes/preview/shown_frames.h"

#include <algorithm>

namespace fluidcarve {

bool is_shown(std::size_t place, std::size_t total, int wanted) {
    const auto count = std::min(total, static_cast<std::size_t>(wanted));
    if (count <= 1) return place == total / 2;
    for (std::size_t n = 0; n < count; ++n)
        if ((2 * n * (total - 1) + count - 1) / (2 * (count - 1)) == place) return true;
    return false;
}

}  // namespace fluidcarve
