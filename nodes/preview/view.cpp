#include "nodes/preview/view.h"

#include <algorithm>

namespace fluidcarve {

std::array<int, 2> picture_axes(View view) {
    switch (view) {
        case View::x: return {1, 2};
        case View::y: return {0, 2};
        case View::z: break;
    }
    return {0, 1};
}

void Area::include(const Area& other) {
    if (other.empty()) return;
    if (empty()) *this = other;
    for (const int side : {0, 1}) {
        first[side] = std::min(first[side], other.first[side]);
        last[side] = std::max(last[side], other.last[side]);
    }
}

Area face_of(const openvdb::CoordBBox& box, View view) {
    const auto [right, up] = picture_axes(view);
    return {{box.min()[right], box.min()[up]}, {box.max()[right], box.max()[up]}};
}

Area in_cells(const Area& area, int cell) {
    Area out;
    for (const int side : {0, 1}) {
        out.first[side] = floor_div(area.first[side], cell);
        out.last[side] = floor_div(area.last[side], cell);
    }
    return out;
}

}  // namespace fluidcarve
