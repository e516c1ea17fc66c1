#pragma once

#include "carve/solver/search/columns.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace fluidcarve {

/// Fewer columns than this are better visited by one thread: waiting for others takes longer.
constexpr std::size_t least_shared_columns = 1 << 13;

/// Visits boxes of columns so that each comes after all boxes before it along every dimension.
/// Boxes whose indices have the same sum are visited in parallel.
/// @param size       columns along each dimension
/// @param box        columns of a box along each dimension
/// @param make_work  makes the buffers of a thread
/// @param visit      called with a ColumnBox and the thread's buffers
/// @param progress   called between the sums, with the share done, 0 to 1
template <class MakeWork, class Visit, class Progress>
void in_wavefront(const std::array<std::size_t, 3>& size, const std::array<std::size_t, 3>& box,
                  const MakeWork& make_work, const Visit& visit, const Progress& progress) {
    std::array<std::size_t, 3> count;
    for (std::size_t d = 0; d < 3; ++d) count[d] = (size[d] + box[d] - 1) / box[d];
    const auto sums = count[0] + count[1] + count[2] - 2;
    std::vector<ColumnBox> boxes;
    for (std::size_t sum = 0; sum < sums; ++sum) {
        progress(static_cast<double>(sum) / static_cast<double>(sums));
        boxes.clear();
        for (std::size_t c = 0; c < std::min(count[2], sum + 1); ++c)
            for (std::size_t a = 0; a < std::min(count[0], sum - c + 1); ++a) {
                const std::array at{a, sum - c - a, c};
                if (at[1] >= count[1]) continue;
                auto& added = boxes.emplace_back();
                for (std::size_t d = 0; d < 3; ++d) {
                    added.begin[d] = at[d] * box[d];
                    added.end[d] = std::min(added.begin[d] + box[d], size[d]);
                }
            }
        const auto visit_some = [&](std::size_t begin, std::size_t end) {
            auto work = make_work();
            for (auto n = begin; n < end; ++n) visit(boxes[n], work);
        };
        if (boxes.size() == 1) visit_some(0, 1);
        else
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boxes.size()),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  visit_some(range.begin(), range.end());
                              });
    }
}

}  // namespace fluidcarve
