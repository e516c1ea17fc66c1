#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fluidcarve {

/// The median; of an even number of values, the upper of the two middle ones.
/// @param of  the values, at least one
template <class T>
T median_of(std::vector<T> of) {
    const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
    std::ranges::nth_element(of, middle);
    return *middle;
}

}  // namespace fluidcarve
