#include "carve/rig/circle.h"

namespace fluidcarve {

using openvdb::Vec3d;

Rig circle_rig(const Vec3d& center, const Vec3d& normal, const std::array<double, 2>& radii,
               double start) {
    const auto n = normal.unit();
    const auto across = [&](const Vec3d& axis) { return axis - axis.dot(n) * n; };
    const auto x =
        across({1, 0, 0}).length() > 1e-6 ? across({1, 0, 0}).unit() : across({0, 1, 0}).unit();
    return oval_rig({center, radii[0] * x, radii[1] * x.cross(n), start}, n);
}

}  // namespace fluidcarve
