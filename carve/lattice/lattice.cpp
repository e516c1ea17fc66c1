#include "carve/lattice/lattice.h"

#include "carve/base/words.h"
#include "carve/lattice/polar.h"

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace fluidcarve {

namespace {

using openvdb::Vec3d;

class LatticeHash {
public:
    LatticeHash() { XXH3_64bits_reset(&state_); }
    void add(std::uint64_t word) { XXH3_64bits_update(&state_, &word, sizeof word); }
    // Adding 0 turns -0 into 0.
    void add(double value) { add(std::bit_cast<std::uint64_t>(value + 0.0)); }
    void add(const Vec3d& value) {
        for (int c = 0; c < 3; ++c) add(value[c]);
    }
    std::string text() const {
        return fmt::format("{}{:016x}", lattice_hash_prefix, XXH3_64bits_digest(&state_));
    }

private:
    XXH3_state_t state_;
};

/// Smallest volume of a box's cell, cubic spacings; flatter cells have no inverse.
constexpr double least_volume = 1e-6;

bool near(const Vec3d& a, const Vec3d& b, double tolerance) {
    return (a - b).length() <= tolerance;
}

/// @param directions  of u, v and w, spacings  @param steps  in words, for the description
Lattice box_of(const Vec3d& first, const std::array<int, 3>& shape, double spacing,
               const std::array<Vec3d, 3>& directions, const std::string& steps) {
    Lattice out;
    out.shape = shape;
    out.spacing = spacing;
    for (int k = 0; k < shape[2]; ++k)
        out.planes.push_back(
            {first + spacing * k * directions[2], directions[0], directions[1], directions[2]});
    const auto last = out.position(Vec3d(shape[0] - 1, shape[1] - 1, shape[2] - 1));
    out.description =
        fmt::format("box of {} x {} x {} vertices from ({}) to ({}), {}", shape[0], shape[1],
                    shape[2], numbers_text(first), numbers_text(last), steps);
    out.hash = lattice_hash(out);
    return out;
}

}  // namespace

std::string to_text(Axis axis) { return std::string(1, "uvwt"[dimension(axis)]); }

bool Lattice::is_box() const {
    if (planes.empty() || closed || around) return false;
    const auto& first = planes.front();
    return std::abs(first.w.dot(first.u.cross(first.v))) > least_volume &&
           std::ranges::all_of(planes, [&](const Plane& plane) {
               const auto expected =
                   first.origin + spacing * static_cast<double>(&plane - planes.data()) * first.w;
               return near(plane.u, first.u, 1e-12) && near(plane.v, first.v, 1e-12) &&
                      near(plane.w, first.w, 1e-12) && near(plane.origin, expected, 1e-9 * spacing);
           });
}

Vec3d Lattice::position(const Vec3d& at) const {
    const auto across =
        around ? Polar(shape[1]).across(at.x(), at.y()) : openvdb::Vec2d(at.x(), at.y());
    const auto on = [&](const Plane& plane) {
        return plane.origin + spacing * (across.x() * plane.u + across.y() * plane.v);
    };
    const auto count = planes.size();
    if (count == 1) return on(planes[0]) + spacing * at.z() * planes[0].w;
    const double below = std::floor(at.z()), last = static_cast<double>(count - 2);
    const double k = closed ? below : std::clamp(below, 0.0, last), c = at.z() - k;
    const auto low = static_cast<std::size_t>(
        closed ? k - static_cast<double>(count) * std::floor(k / static_cast<double>(count)) : k);
    return (1 - c) * on(planes[low]) + c * on(planes[(low + 1) % count]);
}

Lattice extended(const Lattice& lattice, const std::array<int, 3>& below, int behind) {
    auto out = lattice;
    for (std::size_t d = 0; d < 2; ++d) {
        if (below[d] == 0) continue;
        for (auto& plane : out.planes)
            plane.origin -= below[d] * lattice.spacing * (d == 0 ? plane.u : plane.v);
    }
    const auto beside = [&](Lattice::Plane plane, int planes) {
        plane.origin += planes * lattice.spacing * plane.w;
        return plane;
    };
    const auto first = out.planes.front(), last = out.planes.back();
    for (int n = 1; n <= behind; ++n) out.planes.push_back(beside(last, n));
    for (int n = 1; n <= below[2]; ++n) out.planes.insert(out.planes.begin(), beside(first, -n));
    for (std::size_t d = 0; d < 3; ++d) out.shape[d] += below[d];
    out.shape[2] += behind;
    return out;
}

std::string lattice_hash(const Lattice& lattice) {
    LatticeHash hash;
    for (const int n : lattice.shape) hash.add(static_cast<std::uint64_t>(n));
    hash.add(lattice.spacing);
    hash.add(std::uint64_t{lattice.closed});
    hash.add(std::uint64_t{lattice.closed_form});
    hash.add(std::uint64_t{lattice.around});
    for (const auto& plane : lattice.planes)
        for (const auto& vector : {plane.origin, plane.u, plane.v, plane.w}) hash.add(vector);
    return hash.text();
}

Lattice make_box(const Vec3d& first, const std::array<int, 3>& shape, double spacing,
                 const std::array<int, 3>& axes) {
    std::array<Vec3d, 3> direction;
    for (std::size_t n = 0; n < 3; ++n) {
        direction[n] = Vec3d(0);
        direction[n][axes[n]] = 1;
    }
    return box_of(first, shape, spacing, direction,
                  fmt::format("spacing {:g}, axes {}{}{}", spacing, "xyz"[axes[0]], "xyz"[axes[1]],
                              "xyz"[axes[2]]));
}

Lattice make_box(const Vec3d& first, const std::array<int, 3>& shape,
                 const std::array<Vec3d, 3>& steps) {
    const double spacing = steps[0].length();
    return box_of(first, shape, spacing,
                  {steps[0] / spacing, steps[1] / spacing, steps[2] / spacing},
                  fmt::format("steps ({}), ({}), ({})", numbers_text(steps[0]),
                              numbers_text(steps[1]), numbers_text(steps[2])));
}

}  // namespace fluidcarve
