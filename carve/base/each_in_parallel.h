#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace fluidcarve {

/// Calls `visit(n)` for 0 to count - 1, in parallel.
/// @param grain  so many calls in a row, or fewer, are not divided between threads
template <class Visit>
void each_in_parallel(std::size_t count, std::size_t grain, const Visit& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (auto n = range.begin(); n != range.end(); ++n) visit(n);
                      });
}

}  // namespace fluidcarve
