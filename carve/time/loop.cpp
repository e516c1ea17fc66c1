#include "carve/time/loop.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace fluidcarve {

Loop::Shown Loop::shown(std::size_t n) const {
    n %= length;
    Shown out{first + n, frame_before(first + n, length), std::nullopt, 0};
    if (n + fade < length) return out;
    out.fade = n + fade - length;
    out.share = double(*out.fade + 1) / double(fade + 1);
    return out;
}

std::size_t frame_before(std::size_t at, std::size_t length) { return at - std::min(at, length); }

Loop best_loop(const LoopRequest& request, std::size_t frames,
               const std::function<double(std::size_t, std::size_t)>& difference) {
    Loop out;
    for (auto length = request.least; length <= request.most; ++length) {
        const auto fade = request.fade.value_or((length + 3) / 4);
        std::vector<double> off;  // difference of each frame that may fade
        for (auto at = length - fade; at < frames; ++at)
            off.push_back(difference(frame_before(at, length), at));
        for (std::size_t first = 0; first + length <= frames; ++first) {
            const auto from = off.begin() + static_cast<std::ptrdiff_t>(first);
            const double mean =
                std::accumulate(from, from + static_cast<std::ptrdiff_t>(fade), 0.0) / double(fade);
            if (mean < out.difference) out = {first, length, fade, mean};
        }
    }
    return out;
}

}  // namespace fluidcarve
