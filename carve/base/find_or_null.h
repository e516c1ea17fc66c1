#pragma once

#include <algorithm>
#include <ranges>

namespace fluidcarve {

/// The first element of a range that has a value; null: none.
/// @param projection  gives the value of an element, such as &Column::name
template <std::ranges::borrowed_range Range>
auto* find_or_null(Range&& range, const auto& value, auto projection) {
    const auto found = std::ranges::find(range, value, projection);
    return found == std::ranges::end(range) ? nullptr : &*found;
}

}  // namespace fluidcarve
