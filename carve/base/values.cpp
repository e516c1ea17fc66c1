#include "carve/base/values.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {

int Count::of(int size) const {
    return static_cast<int>(std::lround(percent ? value / 100 * size : value));
}

std::string text_of(const Count& count) {
    return fmt::format("{}{}", count.value, count.percent ? "%" : "");
}

}  // namespace fluidcarve
