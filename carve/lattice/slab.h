#pragma once

#include "carve/lattice/cubic_root.h"
#include "carve/lattice/lattice.h"

#include <array>
#include <cstddef>

namespace fluidcarve {

/// The part of a lattice between two neighbouring planes: `x(u, v, c) = o(c) + u U(c) + v V(c)`.
/// `o`, `U` and `V` are linear in `c`, which runs from 0 at the lower plane to 1 at the upper one.
/// This is trilinear interpolation between each cell's eight vertices. Positions are in world
/// units, `u` and `v` in vertices.
class Slab {
public:
    /// The vectors whose products with `p - o(0)` are needed to solve for a point `p`: the
    /// coefficients of the normal `U(c) x V(c)` by powers of c, then U(0), U(1) - U(0), V(0), V(1)
    /// - V(0).
    static constexpr std::size_t parts = 7;
    using Vectors = std::array<openvdb::Vec3d, parts>;
    /// Those products, each affine in `p`, and a 0 that pads them to full SIMD vectors.
    using Products = std::array<double, parts + 1>;

    /// @param hand  1 if `u x v` points along the rig, -1 if against it
    Slab(const Lattice::Plane& low, const Lattice::Plane& high, double spacing, double hand);

    const openvdb::Vec3d& origin() const { return origin_; }
    const Vectors& vectors() const { return vectors_; }

    openvdb::Vec3d origin(double c) const { return origin_ + c * chord_; }
    openvdb::Vec3d step_u(double c) const { return vectors_[3] + c * vectors_[4]; }
    openvdb::Vec3d step_v(double c) const { return vectors_[5] + c * vectors_[6]; }
    openvdb::Vec3d normal(double c) const {
        return vectors_[0] + c * (vectors_[1] + c * vectors_[2]);
    }
    openvdb::Vec3d position(double u, double v, double c) const {
        return origin(c) + u * step_u(c) + v * step_v(c);
    }

    Products products(const openvdb::Vec3d& p) const;
    /// Coefficients of `q(c) = normal(c) . (p - o(c))` (METHOD 3), by powers of c.
    /// @param a, b, c  the first three products of `p`
    std::array<double, 4> cubic(double a, double b, double c) const {
        return {a, b - of_chord_[0], c - of_chord_[1], -of_chord_[2]};
    }
    /// Values that at() needs for a coordinate `c`. All positions with the same c share them.
    struct Level {
        double c;
        /// c times the last coefficients of the chord's products with U and V.
        double chord_u, chord_v;
        double uu, uv, vv, scale;  ///< products of U(c) and V(c), and 1 / (uu vv - uv uv)
    };
    Level level(double c) const;
    /// The coordinates `(u, v, c)` of a position.
    /// @param of     products of the position
    /// @param level  of the root of its cubic
    openvdb::Vec3d at(const Products& of, const Level& level) const;
    openvdb::Vec3d at(const Products& of, double c) const { return at(of, level(c)); }
    /// The same; finds the root as well.
    /// @param from, to  as for cubic_root()
    openvdb::Vec3d solve(const Products& of, double from, double to) const {
        return at(of, cubic_root(cubic(of[0], of[1], of[2]), from, to));
    }

    /// The coordinates `(u, v, c)` of a position by the paper's closed form (eq. 3), from the lower
    /// plane alone. Not the inverse of position() where planes turn.
    openvdb::Vec3d solve_closed_form(const openvdb::Vec3d& p) const;

private:
    openvdb::Vec3d origin_, chord_;
    Vectors vectors_;
    Products of_chord_;
    /// U(c) . U(c), U(c) . V(c) and V(c) . V(c), by powers of c.
    std::array<double, 3> uu_, uv_, vv_;
};

inline Slab::Level Slab::level(double c) const {
    const auto at = [c](const std::array<double, 3>& powers) {
        return powers[0] + c * (powers[1] + c * powers[2]);
    };
    const double uu = at(uu_), uv = at(uv_), vv = at(vv_);
    return {c, c * of_chord_[4], c * of_chord_[6], uu, uv, vv, 1 / (uu * vv - uv * uv)};
}

inline openvdb::Vec3d Slab::at(const Products& of, const Level& level) const {
    const double along_u = of[3] + level.c * (of[4] - of_chord_[3] - level.chord_u),
                 along_v = of[5] + level.c * (of[6] - of_chord_[5] - level.chord_v);
    return {(along_u * level.vv - along_v * level.uv) * level.scale,
            (along_v * level.uu - along_u * level.uv) * level.scale, level.c};
}

}  // namespace fluidcarve
