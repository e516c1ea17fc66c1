#include "nodes/preview/projection.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace fluidcarve {
namespace {

float size_of(float value) { return value; }
float size_of(const openvdb::Vec3s& value) { return value.length(); }

int floor_div(int a, int b) { return a / b - (a % b < 0 ? 1 : 0); }

Window in_cells(const Window& window, int cell) {
    Window out;
    for (const int side : {0, 1}) {
        out.first[side] = floor_div(window.first[side], cell);
        out.last[side] = floor_div(window.last[side], cell);
    }
    return out;
}

void raise(float& value, float other) {
    if (std::isnan(value) || other > value) value = other;
}

Projection blank(int cell, const Window& cells) {
    Projection out;
    out.cell = cell;
    out.cells = cells;
    out.values.assign(static_cast<std::size_t>(cells.size(0)) * cells.size(1), std::numeric_limits<float>::quiet_NaN());
    return out;
}

float& value_at(Projection& out, int right, int up) {
    return out.values[static_cast<std::size_t>(up - out.cells.first[1]) * out.cells.size(0) + (right - out.cells.first[0])];
}

template <class Grid>
Projection project(const Grid& grid, View view, const openvdb::CoordBBox& box, int most) {
    const auto [right, up] = picture_axes(view);
    const auto window = window_of(box, view);
    int cell = 1;
    while (std::max(window.size(0), window.size(1)) / cell >= most) cell *= 2;
    auto out = blank(cell, in_cells(window, cell));

    // Leaves behind each other share pixels, so they are one task.
    using Leaf = typename Grid::TreeType::LeafNodeType;
    const int block = std::max<int>(Leaf::DIM, cell);
    std::map<std::pair<int, int>, std::vector<const Leaf*>> lines;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
        const auto bounds = leaf->getNodeBoundingBox();
        if (box.hasOverlap(bounds)) lines[{floor_div(bounds.min()[right], block), floor_div(bounds.min()[up], block)}].push_back(&*leaf);
    }
    std::vector<const std::vector<const Leaf*>*> tasks;
    for (const auto& [place, leaves] : lines) tasks.push_back(&leaves);
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&, right = right, up = up](std::size_t n) {
        for (const auto* leaf : *tasks[n])
            for (auto value = leaf->cbeginValueOn(); value; ++value) {
                const auto at = value.getCoord();
                if (box.isInside(at)) raise(value_at(out, floor_div(at[right], cell), floor_div(at[up], cell)), size_of(*value));
            }
    });

    auto tile = grid.tree().cbeginValueOn();
    tile.setMaxDepth(tile.getLeafDepth() - 1);
    for (; tile; ++tile) {
        openvdb::CoordBBox bounds;
        tile.getBoundingBox(bounds);
        bounds.intersect(box);
        if (bounds.empty()) continue;
        const auto covered = in_cells(window_of(bounds, view), cell);
        for (int y = covered.first[1]; y <= covered.last[1]; ++y)
            for (int x = covered.first[0]; x <= covered.last[0]; ++x) raise(value_at(out, x, y), size_of(*tile));
    }
    return out;
}

}  // namespace

std::array<int, 2> picture_axes(View view) {
    switch (view) {
        case View::x: return {1, 2};
        case View::y: return {0, 2};
        case View::z: break;
    }
    return {0, 1};
}

void Window::include(const Window& other) {
    if (other.empty()) return;
    if (empty()) *this = other;
    for (const int side : {0, 1}) {
        first[side] = std::min(first[side], other.first[side]);
        last[side] = std::max(last[side], other.last[side]);
    }
}

Window window_of(const openvdb::CoordBBox& box, View view) {
    const auto [right, up] = picture_axes(view);
    return {{box.min()[right], box.min()[up]}, {box.max()[right], box.max()[up]}};
}

Projection maximum_projection(const FloatGrid& grid, View view, const openvdb::CoordBBox& box, int most) { return project(grid, view, box, most); }

Projection maximum_projection(const VectorGrid& grid, View view, const openvdb::CoordBBox& box, int most) { return project(grid, view, box, most); }

Projection fitted(const Projection& projection, int cell, const Window& cells) {
    auto out = blank(cell, cells);
    const int factor = cell / projection.cell;
    const auto& from = projection.cells;
    for (int y = from.first[1]; y <= from.last[1]; ++y)
        for (int x = from.first[0]; x <= from.last[0]; ++x) {
            const int right = floor_div(x, factor);
            const int up = floor_div(y, factor);
            if (right < cells.first[0] || right > cells.last[0] || up < cells.first[1] || up > cells.last[1]) continue;
            raise(value_at(out, right, up), projection.at(x, y));
        }
    return out;
}

}  // namespace fluidcarve
