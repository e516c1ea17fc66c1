#pragma once

#include "carve/solver/search/strip.h"

#include <cstdint>
#include <vector>

namespace fluidcarve {

/// Improves a seam line by line. In each line of columns along each dimension, dynamic programming
/// finds the best entries within 1 of the seam, while the neighbouring lines stay fixed
/// (multi-pass dynamic programming, Furuta et al. 2018). Neighbouring lines take turns.
class LineSweeps {
public:
    /// @param strip  outlives the sweeps
    explicit LineSweeps(const Strip& strip) : strip_(strip) {}

    /// Goes through all lines once.
    /// @param seam  feasible, in the strip, of finite cost; stays so
    /// @param turn  number of the sweep; in a ring of columns it selects the column that stays
    ///   fixed
    void operator()(std::vector<std::uint16_t>& seam, int turn) const;

private:
    template <Stepping stepping>
    class Line;

    template <Stepping stepping>
    void sweep(std::vector<std::uint16_t>& seam, int turn) const;

    const Strip& strip_;
};

}  // namespace fluidcarve
