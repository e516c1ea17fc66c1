#pragma once

#include "carve/solver/search/strip.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fluidcarve {

/// Improves a seam line by line. In each line of columns along each dimension, dynamic programming
/// finds the best entries within 1 of the seam, while the columns beside it stay (multi-pass
/// dynamic programming, Furuta et al. 2018). Neighbouring lines take turns. A line is settled once
/// it finds nothing better. It is left out until a column in it or beside it moves, so that later
/// sweeps only look where something changed.
class LineSweeps {
public:
    /// @param strip  outlives the sweeps
    explicit LineSweeps(const Strip& strip);

    /// Goes through all lines once.
    /// @param seam  feasible, in the strip, of finite cost; stays so. Between the calls nothing
    ///   else may change it.
    /// @param turn  number of the sweep; in a ring of columns it selects the one that stays fixed
    void operator()(std::vector<std::uint16_t>& seam, int turn);

private:
    template <Stepping stepping>
    class Line;

    template <Stepping stepping>
    void sweep(std::vector<std::uint16_t>& seam, int turn);
    /// Whether the line along a dimension, through a place, is settled.
    std::uint8_t& settled(std::size_t along, const std::array<std::size_t, 3>& at);
    /// Has the lines through a column, and those beside it, looked at again.
    void unsettle(std::size_t column);

    const Strip& strip_;
    const std::array<std::size_t, 3> size_;               ///< columns along lateral, k and t
    std::array<std::vector<std::uint8_t>, 3> settled_{};  ///< `[dimension][line]`, 1 or 0
};

}  // namespace fluidcarve
