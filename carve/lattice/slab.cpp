#include "carve/lattice/slab.h"

#include <cstddef>

namespace fluidcarve {

using openvdb::Vec3d;

Slab::Slab(const Lattice::Plane& low, const Lattice::Plane& high, double spacing, double hand)
    : origin_(low.origin), chord_(high.origin - low.origin) {
    const auto u = spacing * low.u, v = spacing * low.v, du = spacing * (high.u - low.u),
               dv = spacing * (high.v - low.v);
    vectors_ = {
        hand * u.cross(v), hand * (u.cross(dv) + du.cross(v)), hand * du.cross(dv), u, du, v, dv};
    for (std::size_t n = 0; n < parts; ++n) of_chord_[n] = vectors_[n].dot(chord_);
    uu_ = {u.dot(u), 2 * u.dot(du), du.dot(du)};
    uv_ = {u.dot(v), u.dot(dv) + du.dot(v), du.dot(dv)};
    vv_ = {v.dot(v), 2 * v.dot(dv), dv.dot(dv)};
}

Slab::Products Slab::products(const Vec3d& p) const {
    const auto from = p - origin_;
    Products out{};
    for (std::size_t n = 0; n < parts; ++n) out[n] = vectors_[n].dot(from);
    return out;
}

Vec3d Slab::solve_closed_form(const Vec3d& p) const {
    const auto a = p - origin_, low = normal(0), high = normal(1);
    const auto on_high = p - (high.dot(p - origin(1)) / high.lengthSqr()) * high;
    return {a.dot(vectors_[3]) / vectors_[3].lengthSqr(),
            a.dot(vectors_[5]) / vectors_[5].lengthSqr(),
            a.dot(low) / (on_high - origin_).dot(low)};
}

}  // namespace fluidcarve
