#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fluidcarve {

/// The middle one of some values, of an even number the upper of both.
/// @param of  at least one
template <class T>
T median_of(std::vector<T> of) {
    const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
    std::ranges::nth_element(of, middle);
    return *middle;
}

}  // namespace fluidcarve
