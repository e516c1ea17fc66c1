#include "nodes/preview/projection.h"

#include "nodes/preview/lines_of_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fluidcarve {

namespace {

Projection blank(int cell, const Area& cells, Projection::Keep keep) {
    Projection out{cell, cells, {}, keep};
    out.values.assign(static_cast<std::size_t>(cells.size(0)) * cells.size(1),
                      std::numeric_limits<float>::quiet_NaN());
    return out;
}

template <class Grid>
Projection project(const Grid& grid, View view, const openvdb::CoordBBox& box, int most) {
    auto out = blank_projection(box, view, most);
    for_each_leaf_in_sight(grid.tree(), view, box, out.cell, [&](const auto& leaf) {
        for (auto value = leaf.cbeginValueOn(); value; ++value) {
            const auto at = value.getCoord();
            if (box.isInside(at)) out.see(at, view, seen_value(*value));
        }
    });

    auto tile = grid.tree().cbeginValueOn();
    tile.setMaxDepth(tile.getLeafDepth() - 1);
    for (; tile; ++tile) {
        openvdb::CoordBBox bounds;
        tile.getBoundingBox(bounds);
        bounds.intersect(box);
        if (bounds.empty()) continue;
        const auto covered = in_cells(face_of(bounds, view), out.cell);
        for (int y = covered.first[1]; y <= covered.last[1]; ++y)
            for (int x = covered.first[0]; x <= covered.last[0]; ++x)
                out.see(x, y, seen_value(*tile));
    }
    return out;
}

}  // namespace

void Projection::see(int right, int up, float value) {
    auto& seen = values[place(right, up)];
    const bool better = keep == Keep::greatest ? value > seen : std::abs(value) > std::abs(seen);
    if (better || std::isnan(seen)) seen = value;
}

void Projection::see(const openvdb::Coord& voxel, View view, float value) {
    const auto [right, up] = picture_axes(view);
    see(floor_div(voxel[right], cell), floor_div(voxel[up], cell), value);
}

Projection blank_projection(const openvdb::CoordBBox& box, View view, int most,
                            Projection::Keep keep) {
    const auto area = face_of(box, view);
    int cell = 1;
    while (std::max(area.size(0), area.size(1)) / cell >= most) cell *= 2;
    return blank(cell, in_cells(area, cell), keep);
}

Projection maximum_projection(const FloatGrid& grid, View view, const openvdb::CoordBBox& box,
                              int most) {
    return project(grid, view, box, most);
}

Projection maximum_projection(const VectorGrid& grid, View view, const openvdb::CoordBBox& box,
                              int most) {
    return project(grid, view, box, most);
}

Projection fitted(const Projection& projection, int cell, const Area& cells) {
    auto out = blank(cell, cells, projection.keep);
    const int factor = cell / projection.cell;
    const auto& from = projection.cells;
    for (int y = from.first[1]; y <= from.last[1]; ++y)
        for (int x = from.first[0]; x <= from.last[0]; ++x) {
            const int right = floor_div(x, factor);
            const int up = floor_div(y, factor);
            if (right < cells.first[0] || right > cells.last[0] || up < cells.first[1] ||
                up > cells.last[1])
                continue;
            out.see(right, up, projection.at(x, y));
        }
    return out;
}

}  // namespace fluidcarve
