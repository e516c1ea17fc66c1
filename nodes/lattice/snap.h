#pragma once

#include <openvdb/Types.h>

#include <cmath>

namespace fluidcarve {

/// Coordinates this near to a whole number are that number (METHOD 3).
inline constexpr double snap_width = 1e-5;
/// Points this far beyond a rim still count as inside, and are moved onto the rim.
inline constexpr double rim_slack = 1e-4;

/// The whole number within snap_width of `x`, else `x`.
inline double snapped(double x) {
    // Rounds without a call: below 2^51 no digit behind the point is left of the sum.
    constexpr double shift = 0x1.8p52;
    const double whole = (x + shift) - shift;
    return std::abs(x - whole) <= snap_width ? whole : x;
}
inline openvdb::Vec3d snapped(const openvdb::Vec3d& x) { return {snapped(x.x()), snapped(x.y()), snapped(x.z())}; }

}  // namespace fluidcarve
