#include "carve/solver/search/bound_messages.h"

namespace fluidcarve {

FLUIDCARVE_WIDE void interpolate(const float* __restrict coarse, std::span<float> out) {
    auto* __restrict const fine = out.data();
    const auto* const coarse_before = coarse - 1;
    for (std::size_t n = 0; n < out.size() / 2; ++n) {
        fine[2 * n] = 0.75f * coarse[n] + 0.25f * coarse_before[n];
        fine[2 * n + 1] = 0.75f * coarse[n] + 0.25f * coarse[n + 1];
    }
    if (const auto n = out.size() / 2; out.size() % 2 != 0)
        fine[2 * n] = 0.75f * coarse[n] + 0.25f * coarse_before[n];
}

void fill_infinite(std::span<float> values) {
    for (std::size_t first = 0; first < values.size(); ++first) {
        if (!std::isinf(values[first])) continue;
        auto behind = first;
        while (behind < values.size() && std::isinf(values[behind])) ++behind;
        auto value = std::numeric_limits<float>::infinity();
        if (first > 0) value = values[first - 1];
        if (behind < values.size()) value = std::min(value, values[behind]);
        std::fill(values.begin() + static_cast<std::ptrdiff_t>(first),
                  values.begin() + static_cast<std::ptrdiff_t>(behind),
                  std::isinf(value) ? 0 : value);
        first = behind;
    }
}

}  // namespace fluidcarve
