#pragma once

#include "nodes/preview/sheet_rows.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve::test {

inline FloatGrid::Ptr named(const std::string& name) {
    auto out = FloatGrid::create(0.0f);
    out->setName(name);
    return out;
}

/// A cube of one value, as voxels.
inline FloatGrid::Ptr cube(const openvdb::Coord& first, int size, float value) {
    auto out = named("density");
    out->denseFill(openvdb::CoordBBox(first, first.offsetBy(size - 1)), value, true);
    return out;
}

inline SheetFrame frame_of(int number, FloatGrid::ConstPtr before, FloatGrid::ConstPtr after) {
    SheetFrame out;
    out.name = "frame " + std::to_string(number);
    out.number = number;
    out.before = std::move(before);
    out.after = std::move(after);
    return out;
}

inline SheetRequest request_for(View view = View::y, std::vector<SheetRequest::Show> shows = {
                                                         SheetRequest::Show::maximum}) {
    SheetRequest out;
    out.grid = "density";
    out.view = view;
    out.shows = std::move(shows);
    out.difference = false;
    return out;
}

inline SheetPage page_of(const SheetRequest& request, const std::vector<SheetFrame>& frames) {
    SheetRows rows(request);
    for (const auto& frame : frames) rows.add(frame);
    return rows.page(frames.size());
}

inline std::vector<std::string> names_of(const SheetPage& page) {
    std::vector<std::string> out;
    for (const auto& row : page.rows) out.push_back(row.name + ": " + row.what);
    return out;
}

inline constexpr int panels_left = 246;

/// Pixels of a colour, and the rectangle that they span.
struct Found {
    int count = 0;
    int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};

inline Found find_within(const Canvas& canvas, Colour colour, int left, int top, int bottom) {
    Found out;
    for (int y = top; y < bottom; ++y)
        for (int x = left; x < canvas.width(); ++x)
            if (canvas.at(x, y) == colour) {
                ++out.count;
                out.left = std::min(out.left, x), out.right = std::max(out.right, x);
                out.top = std::min(out.top, y), out.bottom = std::max(out.bottom, y);
            }
    return out;
}

/// In the panels of a sheet.
inline Found find(const Canvas& canvas, Colour colour) {
    return find_within(canvas, colour, panels_left, 92, canvas.height() - 32);
}

/// In the head of a sheet.
inline Found find_in_head(const Canvas& canvas, Colour colour) {
    return find_within(canvas, colour, 0, 0, 68);
}

}  // namespace fluidcarve::test
