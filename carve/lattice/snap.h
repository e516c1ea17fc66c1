#pragma once

#include <openvdb/Types.h>

#include <cmath>

namespace fluidcarve {

/// Coordinates this close to an integer count as that integer (METHOD 3); vertices or voxels.
inline constexpr double snap_width = 1e-5;
/// Points up to this far beyond a rim count as inside and are moved onto the rim; vertices.
inline constexpr double rim_slack = 1e-4;

/// The integer within snap_width of `x`, else `x`.
inline double snapped(double x) {
    // Rounds without a function call: the sum has no digits behind the point, as long as |x| is
    // below 2^51.
    constexpr double shift = 0x1.8p52;
    const double whole = (x + shift) - shift;
    return std::abs(x - whole) <= snap_width ? whole : x;
}
inline openvdb::Vec3d snapped(const openvdb::Vec3d& x) {
    return {snapped(x.x()), snapped(x.y()), snapped(x.z())};
}

}  // namespace fluidcarve
