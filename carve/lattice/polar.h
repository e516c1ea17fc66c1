#pragma once

#include <openvdb/Types.h>

#include <cmath>

namespace fluidcarve {

/// Coordinates around a rig (METHOD 2 "Around the rig"): `u` is the distance from it, and `v` goes
/// around it from Plane::u over Plane::v. Both are in vertices, as are the coordinates `(x, y)`
/// along Plane::u and Plane::v. On the rig, where u is 0, all v are the same place.
class Polar {
public:
    /// @param vertices  number of vertices in a full turn, at least 3
    explicit Polar(int vertices) : vertices_(vertices) {}

    double turn() const { return vertices_; }  ///< v and v + turn() are the same
    /// The unit vector away from the rig.
    openvdb::Vec2d direction(double v) const {
        const double angle = 2 * M_PI / vertices_ * v;
        return {std::cos(angle), std::sin(angle)};
    }
    /// The `(x, y)` of a place.
    openvdb::Vec2d across(double u, double v) const { return u * direction(v); }
    /// The `(u, v)` of a place; v lies within [0, turn()).
    openvdb::Vec2d around(double x, double y) const {
        const double v = vertices_ / (2 * M_PI) * std::atan2(y, x),
                     positive = v < 0 ? v + vertices_ : v;
        return {std::hypot(x, y), positive < vertices_ ? positive : 0};
    }

private:
    double vertices_;
};

}  // namespace fluidcarve
