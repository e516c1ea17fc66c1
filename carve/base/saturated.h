#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>

namespace fluidcarve {

/// A number as a whole one: rounded towards 0 and clamped to the type's range; what is no number
/// becomes 0.
/// @tparam T  of 32 bits at most, so that a double holds its range
template <std::integral T>
T saturated(double number) {
    static_assert(sizeof(T) <= 4);
    using Limits = std::numeric_limits<T>;
    return std::isnan(number)
               ? T{0}
               : static_cast<T>(std::clamp<double>(number, Limits::lowest(), Limits::max()));
}

}  // namespace fluidcarve
