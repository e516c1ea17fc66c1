#include "carve/lattice/folds.h"

#include "carve/lattice/polar.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

/// Signed distance of a plane's vertices from the neighbouring plane: affine in `(x, y)`, world
/// units, above 0 on the right side.
struct Clearance {
    double at_origin, per_u, per_v;
    double at(const openvdb::Vec2d& across) const {
        return at_origin + across.x() * per_u + across.y() * per_v;
    }
};

/// The vertices of a row, or of a ray away from the rig, that lie on the right side: from `first`
/// on, up to before `end`.
struct Stretch {
    int first, end;

    /// @param at_origin, per_vertex  of the clearance along the ray
    Stretch(double at_origin, double per_vertex, int vertices) : first(0), end(vertices) {
        const double zero = -at_origin / per_vertex, last = vertices;
        if (at_origin > 0 && per_vertex < 0)
            end = static_cast<int>(std::min(std::ceil(zero), last));
        else if (at_origin <= 0)
            first =
                per_vertex > 0 ? static_cast<int>(std::min(std::floor(zero) + 1, last)) : vertices;
    }
    /// The stretch of a row along u.
    Stretch(const Clearance& clearance, int j, int vertices)
        : Stretch(clearance.at({0, static_cast<double>(j)}), clearance.per_u, vertices) {
        // The quotient is rounded: the vertices themselves decide.
        const auto good = [&](int i) { return clearance.at(openvdb::Vec2d(i, j)) > 0; };
        while (first < end && !good(first)) ++first;
        while (first > 0 && good(first - 1)) --first;
        while (end > first && !good(end - 1)) --end;
        while (end < vertices && good(end)) ++end;
    }
    /// Intersects both stretches.
    void clip(const Stretch& other) {
        first = std::max(first, other.first);
        end = std::min(end, other.end);
    }
};

/// Folded cells of a lattice around its rig. @param extent_u  vertices of a ray
std::size_t folded_cells_around(const Clearance& upper, const Clearance& lower, int extent_u,
                                int rays) {
    const Polar polar(rays);
    const auto along = [&](int j) {
        const auto direction = polar.direction(j);
        const auto side = [&](const Clearance& clearance) {
            return Stretch(clearance.at_origin, clearance.at(direction) - clearance.at_origin,
                           extent_u);
        };
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

std::size_t folded_cells(const Clearance& upper, const Clearance& lower, int extent_u,
                         int extent_v) {
    const auto good = [&](int i, int j) {
        const openvdb::Vec2d across(i, j);
        return upper.at(across) > 0 && lower.at(across) > 0;
    };
    const int i_end = extent_u - 1, j_end = extent_v - 1;
    if (good(0, 0) && good(i_end, 0) && good(0, j_end) && good(i_end, j_end)) return 0;
    const auto along = [&](int j) {
        Stretch out(upper, j, extent_u);
        out.clip(Stretch(lower, j, extent_u));
        return out;
    };
    const int cells = std::max(i_end, 1), corners = std::min(extent_u, 2);
    std::size_t out = 0;
    auto row = along(0);
    for (int j = 0; j < std::max(j_end, 1); ++j) {
        const auto next = along(std::min(j + 1, j_end));
        row.clip(next);
        out += static_cast<std::size_t>(cells - std::max(row.end - row.first - corners + 1, 0));
        row = next;
    }
    return out;
}

}  // namespace

Folds count_folds(const Lattice& lattice, int extent_u, int extent_v) {
    const auto& planes = lattice.planes;
    Folds out;
    if (lattice.is_box()) return out;
    for (std::size_t k = 0; k + 1 < planes.size() + (lattice.closed ? 1 : 0); ++k) {
        const auto &low = planes[k], &high = planes[(k + 1) % planes.size()];
        const auto chord = high.origin - low.origin;
        const double step = lattice.spacing;
        const Clearance upper{low.w.dot(chord), step * low.w.dot(high.u), step * low.w.dot(high.v)};
        const Clearance lower{high.w.dot(chord), -step * high.w.dot(low.u),
                              -step * high.w.dot(low.v)};
        const auto cells = lattice.around ? folded_cells_around(upper, lower, extent_u, extent_v)
                                          : folded_cells(upper, lower, extent_u, extent_v);
        out.cells += cells;
        if (cells <= out.in_plane) continue;
        out.in_plane = cells;
        out.plane = static_cast<int>(k);
    }
    return out;
}

}  // namespace fluidcarve
