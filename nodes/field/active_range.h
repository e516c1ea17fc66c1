#pragma once

#include "graph/types/param.h"
#include "nodes/payloads.h"

#include <limits>

namespace fluidcarve {

/// The range of no values at all: joined with another it gives that one.
constexpr Interval empty_range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

/// The least interval that holds both.
Interval joined(const Interval& a, const Interval& b);

/// Smallest and largest active value; low > high if there is none.
/// @throws Failure naming the grid and voxel if an active value is not finite
Interval active_range(const FloatGrid& grid);

}  // namespace fluidcarve
