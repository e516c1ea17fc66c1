#pragma once

#include "nodes/lattice/lattice.h"

#include <array>
#include <cmath>

namespace fluidcarve {

/// The part of a lattice between two neighbouring planes: `x(u, v, c) = o(c) + u U(c) + v V(c)`, all three linear in
/// `c` from 0 at the lower plane to 1 at the upper one. That is trilinear interpolation in each cell's eight vertices.
/// World units; `u` and `v` in vertices.
class Slab {
public:
    /// The vectors that `p - o(0)` is multiplied with to solve for a point: the coefficients of the normal
    /// `U(c) x V(c)` by powers of c, then U(0), U(1) - U(0), V(0), V(1) - V(0).
    static constexpr std::size_t parts = 7;
    using Vectors = std::array<openvdb::Vec3d, parts>;
    /// Their products, each affine in `p`, and a 0 that makes whole vectors of them.
    using Products = std::array<double, parts + 1>;

    /// @param hand  1, or -1 where `u x v` points against the rig
    Slab(const Lattice::Plane& low, const Lattice::Plane& high, double spacing, double hand);

    const openvdb::Vec3d& origin() const { return origin_; }
    const Vectors& vectors() const { return vectors_; }

    openvdb::Vec3d origin(double c) const { return origin_ + c * chord_; }
    openvdb::Vec3d step_u(double c) const { return vectors_[3] + c * vectors_[4]; }
    openvdb::Vec3d step_v(double c) const { return vectors_[5] + c * vectors_[6]; }
    openvdb::Vec3d normal(double c) const { return vectors_[0] + c * (vectors_[1] + c * vectors_[2]); }
    openvdb::Vec3d position(double u, double v, double c) const { return origin(c) + u * step_u(c) + v * step_v(c); }

    Products products(const openvdb::Vec3d& p) const;
    /// The point `(u, v, c)` at a position: `c` is the root of `q(c) = normal(c) . (p - o(c))` (METHOD 3) to 1e-13.
    /// @param of        the position's products, `q(from) >= 0 > q(to)`
    /// @param from, to  0 and 1, or a hair beyond
    openvdb::Vec3d solve(const Products& of, double from, double to) const;

    /// The paper's answer to the same question (eq. 3), from the lower plane alone: not the inverse of position() where
    /// planes turn.
    openvdb::Vec3d solve_closed_form(const openvdb::Vec3d& p) const;

private:
    openvdb::Vec3d origin_, chord_;
    Vectors vectors_;
    Products of_chord_;
    std::array<double, 3> uu_, uv_, vv_;  ///< U(c) . U(c) and so on, by powers of c
};

inline openvdb::Vec3d Slab::solve(const Products& of, double from, double to) const {
    const double q0 = of[0], q1 = of[1] - of_chord_[0], q2 = of[2] - of_chord_[1], q3 = -of_chord_[2];
    // The sides of the planes are known up to rounding only.
    double low = from - 1e-9, high = to + 1e-9;
    double c = q0 / -(q1 + q2 + q3);
    if (!(c >= low && c <= high)) c = (low + high) / 2;
    for (int n = 0; n < 100; ++n) {
        const double q = ((q3 * c + q2) * c + q1) * c + q0, slope = (3 * q3 * c + 2 * q2) * c + q1;
        (q >= 0 ? low : high) = c;
        const double step = q / slope, next = c - step;
        if (!(next >= low && next <= high)) {
            c = (low + high) / 2;
            if (high - low <= 1e-13) break;
            continue;
        }
        c = next;
        // What a step leaves of an error e is e^2 q'' / 2 q'.
        if (std::abs((3 * q3 * c + q2) * step * step) <= 1e-13 * std::abs(slope)) break;
    }

    const double along_u = of[3] + c * (of[4] - of_chord_[3] - c * of_chord_[4]), along_v = of[5] + c * (of[6] - of_chord_[5] - c * of_chord_[6]);
    const auto at = [c](const std::array<double, 3>& powers) { return powers[0] + c * (powers[1] + c * powers[2]); };
    const double uu = at(uu_), uv = at(uv_), vv = at(vv_), scale = 1 / (uu * vv - uv * uv);
    return {(along_u * vv - along_v * uv) * scale, (along_v * uu - along_u * uv) * scale, c};
}

}  // namespace fluidcarve
