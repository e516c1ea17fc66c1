#include "carve/base/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

int Count::of(int size) const {
    constexpr double most = 1e9;
    return static_cast<int>(std::lround(std::clamp(exactly(size), -most, most)));
}

std::string to_text(const Count& count) {
    return fmt::format("{}{}", count.value, count.percent ? "%" : "");
}

}  // namespace fluidcarve
