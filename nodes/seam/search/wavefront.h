#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace fluidcarve {

/// Visits the cells of a grid so that each comes after those before it along every dimension. Cells whose indices have the same sum are
/// visited at once.
/// @param size   cells along each dimension
/// @param visit  called with some of the cells at a time, as `std::span<const std::array<std::size_t, 3>>`
/// @param tick   called between the sums, with the share of the way, 0 to 1
template <class Visit, class Tell>
void in_wavefront(const std::array<std::size_t, 3>& size, const Visit& visit, const Tell& tick) {
    const auto sums = size[0] + size[1] + size[2] - 2;
    std::vector<std::array<std::size_t, 3>> cells;
    for (std::size_t sum = 0; sum < sums; ++sum) {
        tick(static_cast<double>(sum) / static_cast<double>(sums));
        cells.clear();
        for (std::size_t c = 0; c < std::min(size[2], sum + 1); ++c)
            for (std::size_t a = 0; a < std::min(size[0], sum - c + 1); ++a)
                if (const auto b = sum - c - a; b < size[1]) cells.push_back({a, b, c});
        if (cells.size() == 1) {
            visit(std::span<const std::array<std::size_t, 3>>(cells));
            continue;
        }
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size()), [&](const tbb::blocked_range<std::size_t>& range) {
            visit(std::span<const std::array<std::size_t, 3>>(cells).subspan(range.begin(), range.size()));
        });
    }
}

}  // namespace fluidcarve
