#include "carve/lattice/directions.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

Vec3d reflected(const Vec3d& a, const Vec3d& normal) {
    return a - 2 / normal.lengthSqr() * normal.dot(a) * normal;
}

Vec3d orthogonal(const Vec3d& a, const Vec3d& unit) { return a - unit.dot(a) * unit; }

/// Carries `v` from one plane to the next.
Vec3d carried(const Vec3d& v, const Vec3d& w, const Vec3d& chord, const Vec3d& next_w) {
    // Keeps `v` exactly on straight stretches, so that it does not drift.
    if (w == next_w) return v;
    const auto normal = next_w - reflected(w, chord);
    return orthogonal(reflected(reflected(v, chord), normal), next_w).unit();
}

}  // namespace

std::vector<Vec3d> plane_directions(const Resampled& line, bool closed, bool to_next) {
    const auto& chords = line.chords;
    std::vector<Vec3d> out;
    for (std::size_t k = 0; k < line.points.size(); ++k) {
        const bool last = k == chords.size(), first = k == 0 && !closed;
        if (last || first || to_next) {
            out.push_back(chords[last ? k - 1 : k]);
            continue;
        }
        const auto& before = chords[k == 0 ? chords.size() - 1 : k - 1];
        const auto sum = before + chords[k];
        if (sum.length() < 0.02)
            throw Failure(
                fmt::format("the rig turns right back within one spacing near {}, plane {}; smooth "
                            "it, or take another spacing",
                            to_text(line.points[k]), k));
        out.push_back(before == chords[k] ? before : sum.unit());
    }
    return out;
}

std::vector<Vec3d> untwisted(const Resampled& line, const std::vector<Vec3d>& w, bool closed,
                             const Vec3d& up) {
    const auto first = orthogonal(up.unit(), w.front());
    if (first.length() < 1e-6)
        throw Failure(
            fmt::format("the rig starts along its 'up', {}, which leaves the direction of v open; "
                        "state another 'up'",
                        to_text(up)));
    std::vector<Vec3d> out{first.unit()};
    for (std::size_t k = 1; k < w.size(); ++k)
        out.push_back(carried(out.back(), w[k - 1], line.chords[k - 1], w[k]));
    if (!closed) return out;

    const auto back = carried(out.back(), w.back(), line.chords.back(), w.front());
    const double turned = std::atan2(out.front().cross(back).dot(w.front()), out.front().dot(back));
    for (std::size_t k = 1; k < w.size(); ++k) {
        const double angle = -turned * static_cast<double>(k) / static_cast<double>(w.size());
        out[k] = std::cos(angle) * out[k] + std::sin(angle) * w[k].cross(out[k]);
    }
    return out;
}

}  // namespace fluidcarve
