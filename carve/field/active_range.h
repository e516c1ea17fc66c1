#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <limits>

namespace fluidcarve {

/// The range of no values. Joined with another range it gives that range.
constexpr Interval empty_range{std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity()};

/// The smallest interval that contains both.
Interval joined(const Interval& a, const Interval& b);

/// Smallest and largest active value; low > high if there is none.
/// @throws Failure naming the grid and the voxel if an active value is not finite
Interval active_range(const FloatGrid& grid);

}  // namespace fluidcarve
