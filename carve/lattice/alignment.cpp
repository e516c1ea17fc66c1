#include "carve/lattice/alignment.h"

#include "carve/field/extent.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

using openvdb::Coord;
using openvdb::Vec3d;

namespace {
/// Largest distance of a vertex from its voxel, voxels. Corners of a box come rounded: lattice.box
/// accepts errors of 1e-3 of a spacing.
constexpr double whole = 2e-3;
}  // namespace

bool Alignment::one_to_one() const {
    Coord sum(0);
    for (const auto& s : step) {
        if (std::abs(s.x()) + std::abs(s.y()) + std::abs(s.z()) != 1) return false;
        sum += Coord(std::abs(s.x()), std::abs(s.y()), std::abs(s.z()));
    }
    return sum == Coord(1);
}

Coord Alignment::vertex(const Coord& voxel) const {
    const auto from = voxel - origin;
    const auto along = [&](const Coord& s) {
        return from.x() * s.x() + from.y() * s.y() + from.z() * s.z();
    };
    return {along(step[0]), along(step[1]), along(step[2])};
}

std::optional<Alignment> align(const Lattice& lattice, const openvdb::math::Transform& transform) {
    if (!lattice.is_box() || !transform.isLinear()) return std::nullopt;
    const auto index = [&](int i, int j, int k) {
        return transform.worldToIndex(lattice.position(Vec3d(i, j, k)));
    };
    // A dimension of one vertex still has a direction: insertions extend the lattice along it.
    std::array<int, 3> far;
    for (std::size_t n = 0; n < 3; ++n) far[n] = std::max(1, lattice.shape[n] - 1);

    for (int n = 0; n < 8; ++n)
        if (!voxel_at(index(n & 1 ? far[0] : 0, n & 2 ? far[1] : 0, n & 4 ? far[2] : 0)))
            return std::nullopt;
    const auto first = index(0, 0, 0);
    Alignment out;
    out.origin = Coord::round(first);
    for (std::size_t n = 0; n < 3; ++n) {
        const auto end = index(n == 0 ? far[0] : 0, n == 1 ? far[1] : 0, n == 2 ? far[2] : 0);
        out.step[n] = Coord::round((end - first) / far[n]);
    }
    for (int n = 0; n < 8; ++n) {
        const int i = n & 1 ? far[0] : 0, j = n & 2 ? far[1] : 0, k = n & 4 ? far[2] : 0;
        const auto off = index(i, j, k) - out.voxel(i, j, k).asVec3d();
        if (std::max({std::abs(off.x()), std::abs(off.y()), std::abs(off.z())}) > whole)
            return std::nullopt;
    }
    return out;
}

Lattice on_voxels(const Lattice& lattice, const Alignment& alignment,
                  const openvdb::math::Transform& transform) {
    const auto first = transform.indexToWorld(alignment.origin);
    std::array<Vec3d, 3> step;
    for (std::size_t n = 0; n < 3; ++n)
        step[n] = transform.indexToWorld(alignment.origin + alignment.step[n]) - first;
    auto out = lattice;
    out.spacing = step[0].length();
    for (std::size_t k = 0; k < out.planes.size(); ++k)
        out.planes[k] = {first + static_cast<double>(k) * step[2], step[0] / out.spacing,
                         step[1] / out.spacing, step[2] / out.spacing};
    return out;
}

}  // namespace fluidcarve
