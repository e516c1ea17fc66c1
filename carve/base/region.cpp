#include "carve/base/region.h"

#include "carve/base/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace fluidcarve {

bool meet(const std::vector<Region::Box>& a, const std::vector<Region::Box>& b) {
    const auto overlap = [](const Region::Box& one, const Region::Box& other) {
        for (std::size_t n = 0; n < 3; ++n)
            if (one.high[n] < other.low[n] || other.high[n] < one.low[n]) return false;
        return true;
    };
    return std::ranges::any_of(a, [&](const Region::Box& one) {
        return std::ranges::any_of(b,
                                   [&](const Region::Box& other) { return overlap(one, other); });
    });
}

Region::Box around(const std::vector<Region::Box>& boxes) {
    auto out = boxes.front();
    for (const auto& box : boxes)
        for (std::size_t n = 0; n < 3; ++n) {
            out.low[n] = std::min(out.low[n], box.low[n]);
            out.high[n] = std::max(out.high[n], box.high[n]);
        }
    return out;
}

Region widened(Region region, double by) {
    const auto widen = [by](std::vector<Region::Box>& boxes) {
        for (auto& box : boxes)
            for (std::size_t n = 0; n < 3; ++n) {
                box.low[n] -= by;
                box.high[n] += by;
            }
    };
    widen(region.boxes);
    for (auto& other : region.otherwise) widen(other.boxes);
    return region;
}

std::string to_text(const Region::Box& box) {
    return fmt::format("({}) to ({})", numbers_text(box.low), numbers_text(box.high));
}

}  // namespace fluidcarve
