#pragma once

#include "carve/solver/costs/energy_volume.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstddef>

namespace fluidcarve {

/// A sum of numbers, and their count.
struct Sum {
    double value = 0;
    std::size_t count = 0;
    Sum& operator+=(const Sum& other) {
        value += other.value;
        count += other.count;
        return *this;
    }
    double mean() const { return count > 0 ? value / static_cast<double>(count) : 0; }
};

/// The greatest of some numbers, at least 0.
struct Greatest {
    float value = 0;
    Greatest& operator+=(const Greatest& other) {
        value = std::max(value, other.value);
        return *this;
    }
};

/// Calls `visit(sum, column)` for all columns and adds partial sums in a fixed order, so that the
/// result does not depend on the threads.
template <class Sum, class Visit>
Sum summed_over(const EnergyVolume& energy, const Visit& visit) {
    const auto columns = energy.columns_per_frame() * energy.frames();
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, columns, 4096), Sum{},
        [&](const tbb::blocked_range<std::size_t>& range, Sum sum) {
            for (auto c = range.begin(); c < range.end(); ++c) visit(sum, c);
            return sum;
        },
        [](Sum a, const Sum& b) { return a += b; });
}

}  // namespace fluidcarve
