#include "nodes/lattice/folds.h"

#include "nodes/lattice/polar.h"

#include <algorithm>
#include <optional>

namespace fluidcarve {

namespace {

/// How far the vertices of a plane lie on the right side of the neighbouring plane: affine in `(x, y)`, world units, above 0 if right.
struct Clearance {
    double at_origin, per_u, per_v;
    double at(const openvdb::Vec2d& across) const { return at_origin + across.x() * per_u + across.y() * per_v; }
};

/// @param polar  the coordinates around the rig, if the lattice goes around it
std::size_t folded_cells(const Clearance& upper, const Clearance& lower, int extent_u, int extent_v, const std::optional<Polar>& polar) {
    const auto good = [&](int i, int j) {
        const auto across = polar ? polar->across(i, j) : openvdb::Vec2d(i, j);
        return upper.at(across) > 0 && lower.at(across) > 0;
    };
    if (polar) {
        std::size_t out = 0;
        for (int i = 0; i + 1 < extent_u; ++i)
            for (int j = 0; j < extent_v; ++j)
                if (!(good(i, j) && good(i + 1, j) && good(i, j + 1) && good(i + 1, j + 1))) ++out;
        return out;
    }
    const int i_end = extent_u - 1, j_end = extent_v - 1;
    if (good(0, 0) && good(i_end, 0) && good(0, j_end) && good(i_end, j_end)) return 0;
    std::size_t out = 0;
    for (int i = 0; i < std::max(i_end, 1); ++i)
        for (int j = 0; j < std::max(j_end, 1); ++j) {
            const int next_i = std::min(i + 1, i_end), next_j = std::min(j + 1, j_end);
            if (!(good(i, j) && good(next_i, j) && good(i, next_j) && good(next_i, next_j))) ++out;
        }
    return out;
}

}  // namespace

Folds count_folds(const Lattice& lattice, int extent_u, int extent_v) {
    const auto& planes = lattice.planes;
    const auto polar = lattice.around ? std::optional<Polar>(lattice.shape[1]) : std::nullopt;
    Folds out;
    for (std::size_t k = 0; k + 1 < planes.size() + (lattice.closed ? 1 : 0); ++k) {
        const auto &low = planes[k], &high = planes[(k + 1) % planes.size()];
        const auto chord = high.origin - low.origin;
        const double step = lattice.spacing;
        const Clearance upper{low.w.dot(chord), step * low.w.dot(high.u), step * low.w.dot(high.v)};
        const Clearance lower{high.w.dot(chord), -step * high.w.dot(low.u), -step * high.w.dot(low.v)};
        const auto cells = folded_cells(upper, lower, extent_u, extent_v, polar);
        out.cells += cells;
        if (cells <= out.in_plane) continue;
        out.in_plane = cells;
        out.plane = static_cast<int>(k);
    }
    return out;
}

}  // namespace fluidcarve
