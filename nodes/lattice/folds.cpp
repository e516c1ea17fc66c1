#include "nodes/lattice/folds.h"

#include "nodes/lattice/polar.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

/// How far the vertices of a plane lie on the right side of the neighbouring plane: affine in `(x, y)`, world units, above 0 if right.
struct Clearance {
    double at_origin, per_u, per_v;
    double at(const openvdb::Vec2d& across) const { return at_origin + across.x() * per_u + across.y() * per_v; }
};

/// The vertices of a ray away from the rig that lie on the right side: from `first` on, up to before `end`.
struct Stretch {
    int first, end;

    /// @param at_origin, per_vertex  of the clearance along the ray
    Stretch(double at_origin, double per_vertex, int vertices) : first(0), end(vertices) {
        const double zero = -at_origin / per_vertex, last = vertices;
        if (at_origin > 0 && per_vertex < 0) end = static_cast<int>(std::min(std::ceil(zero), last));
        else if (at_origin <= 0) first = per_vertex > 0 ? static_cast<int>(std::min(std::floor(zero) + 1, last)) : vertices;
    }
    /// The part that is in both.
    void clip(const Stretch& other) {
        first = std::max(first, other.first);
        end = std::min(end, other.end);
    }
};

/// Of a lattice around its rig. @param extent_u  vertices of a ray
std::size_t folded_cells_around(const Clearance& upper, const Clearance& lower, int extent_u, int rays) {
    const Polar polar(rays);
    const auto along = [&](int j) {
        const auto direction = polar.direction(j);
        const auto side = [&](const Clearance& clearance) { return Stretch(clearance.at_origin, clearance.at(direction) - clearance.at_origin, extent_u); };
        auto out = side(upper);
        out.clip(side(lower));
        return out;
    };
    std::size_t out = 0;
    for (int j = 0; j < rays; ++j) {
        auto good = along(j);
        good.clip(along(j + 1));
        out += static_cast<std::size_t>(extent_u - 1 - std::max(good.end - good.first - 1, 0));
    }
    return out;
}

std::size_t folded_cells(const Clearance& upper, const Clearance& lower, int extent_u, int extent_v) {
    const auto good = [&](int i, int j) {
        const openvdb::Vec2d across(i, j);
        return upper.at(across) > 0 && lower.at(across) > 0;
    };
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
    Folds out;
    for (std::size_t k = 0; k + 1 < planes.size() + (lattice.closed ? 1 : 0); ++k) {
        const auto &low = planes[k], &high = planes[(k + 1) % planes.size()];
        const auto chord = high.origin - low.origin;
        const double step = lattice.spacing;
        const Clearance upper{low.w.dot(chord), step * low.w.dot(high.u), step * low.w.dot(high.v)};
        const Clearance lower{high.w.dot(chord), -step * high.w.dot(low.u), -step * high.w.dot(low.v)};
        const auto cells = lattice.around ? folded_cells_around(upper, lower, extent_u, extent_v) : folded_cells(upper, lower, extent_u, extent_v);
        out.cells += cells;
        if (cells <= out.in_plane) continue;
        out.in_plane = cells;
        out.plane = static_cast<int>(k);
    }
    return out;
}

}  // namespace fluidcarve
