#include "carve/field/curvature.h"

#include "carve/field/jacobian.h"
#include "carve/field/stencil.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::Vec3d;

/// Limit of the curvature: that of a ball with a radius of one voxel, 1 / voxel.
constexpr double sharpest = 2;

/// Curvature at a voxel, 1 / world unit. In double precision: in a nearly constant field,
/// differences of floats would be rounding errors.
template <class Accessor>
double curvature(Accessor& field, const Coord& at, const Jacobian& jacobian) {
    double s[3][3][3];
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                // The corners of the cube are not needed.
                if (x != 0 && y != 0 && z != 0) continue;
                float value;
                if (!field.probeValue(at.offsetBy(x, y, z), value)) return 0;
                s[x + 1][y + 1][z + 1] = value;
            }
    const double centre = s[1][1][1];
    const auto g = jacobian.first({0.5 * (s[2][1][1] - s[0][1][1]), 0.5 * (s[1][2][1] - s[1][0][1]),
                                   0.5 * (s[1][1][2] - s[1][1][0])});
    const double square = g.lengthSqr();
    if (!(square > 0)) return 0;
    const double xx = s[2][1][1] - 2 * centre + s[0][1][1],
                 yy = s[1][2][1] - 2 * centre + s[1][0][1],
                 zz = s[1][1][2] - 2 * centre + s[1][1][0];
    const double xy = 0.25 * (s[2][2][1] - s[2][0][1] - s[0][2][1] + s[0][0][1]);
    const double yz = 0.25 * (s[1][2][2] - s[1][2][0] - s[1][0][2] + s[1][0][0]);
    const double zx = 0.25 * (s[2][1][2] - s[0][1][2] - s[2][1][0] + s[0][1][0]);
    const auto second = jacobian.second({xx, xy, zx, xy, yy, yz, zx, yz, zz});
    const double trace = second(0, 0) + second(1, 1) + second(2, 2), along = g.dot(second * g);
    return std::clamp((square * trace - along) / (square * std::sqrt(square)),
                      -sharpest / jacobian.edge(), sharpest / jacobian.edge());
}

}  // namespace

FloatGrid::Ptr curvature_field(const FloatGrid& field) {
    const auto out =
        map_stencil<FloatGrid>(field, 0.0f, [jacobian = Jacobian(field)](auto& s, const Coord& at) {
            return static_cast<float>(curvature(s, at, jacobian));
        });
    out->setName("curvature of " + field.getName());
    return out;
}

}  // namespace fluidcarve
