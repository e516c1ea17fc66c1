#include "nodes/preview/shown_frames.h"

#include <algorithm>

namespace fluidcarve {

bool is_shown(std::size_t t, std::size_t total, int wanted) {
    const auto count = std::min(total, static_cast<std::size_t>(wanted));
    if (count <= 1) return t == total / 2;
    for (std::size_t n = 0; n < count; ++n)
        if ((2 * n * (total - 1) + count - 1) / (2 * (count - 1)) == t) return true;
    return false;
}

}  // namespace fluidcarve
