#pragma once

#include "carve/lattice/lattice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

namespace fluidcarve::test {

inline double between(std::mt19937& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

inline Lattice with_planes(const std::array<int, 3>& shape, double spacing, bool closed,
                           std::vector<Lattice::Plane> planes, std::string description) {
    Lattice out;
    out.shape = shape;
    out.spacing = spacing;
    out.closed = closed;
    out.planes = std::move(planes);
    out.description = std::move(description);
    out.hash = lattice_hash(out);
    return out;
}

/// The radius on which `planes` origins stand `spacing` apart around a circle.
inline double ring_radius(int planes, double spacing) {
    return spacing / (2 * std::sin(M_PI / planes));
}

/// Planes around the z axis through `centre`, u outward and v up, clockwise seen from above.
/// @param first  vertex (0, 0, k): that far outward from the circle, and that far up, world units
inline Lattice ring(const openvdb::Vec3d& centre, const std::array<int, 3>& shape, double spacing,
                    const openvdb::Vec2d& first) {
    using openvdb::Vec3d;
    std::vector<Lattice::Plane> planes;
    for (int k = 0; k < shape[2]; ++k) {
        const double angle = -2 * M_PI * k / shape[2];
        const Vec3d u(std::cos(angle), std::sin(angle), 0), v(0, 0, 1);
        planes.push_back({centre + (ring_radius(shape[2], spacing) + first.x()) * u + first.y() * v,
                          u, v, u.cross(v)});
    }
    return with_planes(shape, spacing, true, planes, "ring");
}

/// Planes across a curve, about its middle, `v` upward as far as it can be.
/// @param at     position on the curve, by the number of the plane
/// @param twist  radians by which u and v are turned about the curve
inline Lattice along(const std::function<openvdb::Vec3d(double)>& at,
                     const std::function<double(double)>& twist, const std::array<int, 3>& shape,
                     double spacing, bool closed) {
    using openvdb::Vec3d;
    std::vector<Lattice::Plane> planes;
    for (int k = 0; k < shape[2]; ++k) {
        const auto w = (at(k + 0.5) - at(k - 0.5)).unit();
        const auto up = (Vec3d(0, 0, 1) - w.z() * w).unit();
        const auto side = up.cross(w);
        const double angle = twist(k);
        const auto u = std::cos(angle) * side + std::sin(angle) * up,
                   v = std::cos(angle) * up - std::sin(angle) * side;
        planes.push_back(
            {at(k) - spacing * (0.5 * (shape[0] - 1) * u + 0.5 * (shape[1] - 1) * v), u, v, w});
    }
    return with_planes(shape, spacing, closed, planes, closed ? "closed curve" : "open curve");
}

/// A helix about the z axis, open.
inline Lattice helix(const std::array<int, 3>& shape, double spacing, double radius, double rise) {
    const double turn = spacing / std::hypot(radius, rise);
    return along(
        [=](double k) {
            return openvdb::Vec3d(radius * std::cos(turn * k), radius * std::sin(turn * k),
                                  rise * turn * k);
        },
        [](double) { return 0.0; }, shape, spacing, false);
}

/// Random and smooth, without folds: planes a spacing apart, give or take some percent, that turn
/// and twist.
inline Lattice random_bent(std::mt19937& random, bool closed) {
    using openvdb::Vec3d;
    std::uniform_real_distribution<double> unit(0, 1);
    const std::array<int, 3> shape{2 + static_cast<int>(random() % 9),
                                   2 + static_cast<int>(random() % 9),
                                   80 + static_cast<int>(random() % 60)};
    const double spacing = 0.05 + unit(random), radius = shape[2] * spacing / (2 * M_PI),
                 share = closed ? 1 : 0.8;
    const Vec3d centre(10 * unit(random), 10 * unit(random), 10 * unit(random)),
        phase(6 * unit(random), 6 * unit(random), 6 * unit(random));
    const double wobble = 0.06 * unit(random), rise = 0.1 * unit(random),
                 twist = 0.7 * unit(random);
    const auto angle = [=](double k) { return share * 2 * M_PI * k / shape[2]; };
    return along(
        [=](double k) {
            const double a = angle(k),
                         r = radius * (1 + wobble * std::cos(3 * a + phase.x())) / share;
            return centre + Vec3d(r * std::cos(a), r * std::sin(a),
                                  radius * rise * std::cos(2 * a + phase.y()));
        },
        [=](double k) { return twist * std::sin(angle(k) + phase.z()); }, shape, spacing, closed);
}

/// The same lattice but for a tilt far below any tolerance, which makes it a general one.
inline Lattice as_planes(Lattice box) {
    auto& plane = box.planes[box.planes.size() / 2];
    plane.u += 1e-11 * plane.w;
    box.hash = lattice_hash(box);
    return box;
}

}  // namespace fluidcarve::test
