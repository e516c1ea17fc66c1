#include "tools/compare/picture.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/volume/grid_types.h"
#include "nodes/preview/projection.h"
#include "nodes/preview/sheet_page.h"
#include "nodes/preview/sheet_style.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fluidcarve {
namespace {

using openvdb::Coord;

using namespace sheet_style;

constexpr double gap = 14;
constexpr double header = 100;
constexpr double caption = 26;
constexpr double scale_height = 56;  // of the colour scales at the bottom
constexpr double least_column = 200;
constexpr int most_cells = 512;      // on a side of a slice
constexpr double wanted_side = 360;  // of the largest slice, pixels

/// The slices of one view: A, B, and B - A. NaN where no voxel is active.
struct Slices {
    View view;
    std::array<Projection, 3> panels;
};

template <class T>
double seen(const T& value) {
    if constexpr (openvdb::VecTraits<T>::IsVec) return openvdb::Vec3d(value).length();
    else return static_cast<double>(value);
}

/// B - A; of vectors, the length.
template <class T>
double change(const T& a, const T& b) {
    if constexpr (openvdb::VecTraits<T>::IsVec)
        return (openvdb::Vec3d(b) - openvdb::Vec3d(a)).length();
    else return static_cast<double>(b) - static_cast<double>(a);
}

/// Slices through a voxel. In wide slices a cell is several voxels; it shows the one that lies in
/// it as the voxel lies in its own.
template <class GridT>
Slices slices_through(const GridT& a, const GridT& b, const openvdb::CoordBBox& box,
                      const Coord& voxel, View view) {
    const auto [right, up] = picture_axes(view);
    const auto size = extents_of(box);
    int cell = 1;
    while (std::max(size[static_cast<std::size_t>(right)], size[static_cast<std::size_t>(up)]) /
               cell >=
           most_cells)
        cell *= 2;
    Projection blank{cell, in_cells(face_of(box, view), cell), {}, Projection::Keep::greatest};
    Slices out{view, {blank, blank, blank}};
    const auto in_a = a.getConstAccessor(), in_b = b.getConstAccessor();
    const auto within = [&](int axis) { return voxel[axis] - floor_div(voxel[axis], cell) * cell; };
    auto at = voxel;
    for (int y = blank.cells.first[1]; y <= blank.cells.last[1]; ++y)
        for (int x = blank.cells.first[0]; x <= blank.cells.last[0]; ++x) {
            at[right] = x * cell + within(right);
            at[up] = y * cell + within(up);
            const bool on_a = in_a.isValueOn(at), on_b = in_b.isValueOn(at);
            constexpr auto nothing = std::numeric_limits<float>::quiet_NaN();
            const auto &value_a = in_a.getValue(at), &value_b = in_b.getValue(at);
            out.panels[0].values.push_back(on_a ? static_cast<float>(seen(value_a)) : nothing);
            out.panels[1].values.push_back(on_b ? static_cast<float>(seen(value_b)) : nothing);
            out.panels[2].values.push_back(
                on_a || on_b ? static_cast<float>(change(value_a, value_b)) : nothing);
        }
    return out;
}

template <class GridT>
std::vector<Slices> all_slices(const GridT& a, const GridT& b, const Coord& voxel) {
    auto box = a.evalActiveVoxelBoundingBox();
    box.expand(b.evalActiveVoxelBoundingBox());
    box.expand(voxel);
    const auto size = extents_of(box);
    std::vector<Slices> out;
    for (const auto view : {View::z, View::y, View::x}) {
        const auto [right, up] = picture_axes(view);
        if (size[static_cast<std::size_t>(right)] > 1 && size[static_cast<std::size_t>(up)] > 1)
            out.push_back(slices_through(a, b, box, voxel, view));
    }
    // A line of voxels, or one alone.
    if (out.empty())
        out.push_back(slices_through(a, b, box, voxel, size[2] > 1 ? View::y : View::z));
    return out;
}

std::vector<Slices> slices_of(const openvdb::GridBase& a, const openvdb::GridBase& b,
                              const Coord& voxel) {
#define FLUIDCARVE_SLICES(GridT)                \
    if (a.isType<GridT>() && b.isType<GridT>()) \
        return all_slices(static_cast<const GridT&>(a), static_cast<const GridT&>(b), voxel);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_SLICES)
#undef FLUIDCARVE_SLICES
    throw Failure(
        fmt::format("grid '{}' is of type {}, which can't be drawn", a.getName(), a.type()));
}

/// The page of a difference.
class DifferencePage {
public:
    DifferencePage(const DrawnDifference& shown, std::vector<Slices> rows, const Coord& voxel)
        : shown_(shown),
          rows_(std::move(rows)),
          voxel_(voxel),
          zoom_(zoom_of(rows_)),
          column_(std::max(least_column, widest())),
          canvas_(static_cast<int>(2 * margin + 3 * column_ + 2 * gap),
                  static_cast<int>(header + height() + scale_height), paper) {
        SheetRow values{{}, {}, SheetRow::Scale::value, {}},
            changes{{}, {}, SheetRow::Scale::change, {}};
        for (const auto& row : rows_)
            for (std::size_t n = 0; n < row.panels.size(); ++n) {
                SheetPanel panel;
                panel.projection = row.panels[n];
                (n < 2 ? values : changes).panels.push_back(std::move(panel));
            }
        value_range_ = range_of({values}, SheetRow::Scale::value);
        change_range_ = range_of({changes}, SheetRow::Scale::change);
    }

    Canvas draw() {
        const double room = canvas_.width() - 2 * margin;
        canvas_.text(margin, 36, canvas_.fitting(shown_.title, title, room), title);
        canvas_.text(margin, 58, canvas_.fitting("A: " + shown_.paths.a, plain, room), plain);
        canvas_.text(margin, 74, canvas_.fitting("B: " + shown_.paths.b, plain, room), plain);
        constexpr std::array names{"A", "B", "B - A"};
        for (std::size_t n = 0; n < names.size(); ++n)
            canvas_.text(left(n), header - 4, names[n], heading);
        double y = header;
        for (const auto& row : rows_) {
            const auto [right, up] = picture_axes(row.view);
            const auto axis = static_cast<int>(row.view);
            canvas_.text(margin, y + 17,
                         fmt::format("slice at {} = {}, {} to the right, {} up", "xyz"[axis],
                                     voxel_[axis], "xyz"[right], "xyz"[up]),
                         plain);
            y += caption;
            for (std::size_t n = 0; n < row.panels.size(); ++n) draw_panel(row, n, y);
            y += zoom_ * row.panels[0].cells.size(1);
        }
        draw_scale({left(0), y + gap, 2 * column_ + gap, 12}, SheetRow::Scale::value, value_range_);
        draw_scale({left(2), y + gap, column_, 12}, SheetRow::Scale::change, change_range_);
        return std::move(canvas_);
    }

private:
    static double zoom_of(const std::vector<Slices>& rows) {
        int side = 1;
        for (const auto& row : rows)
            side = std::max({side, row.panels[0].cells.size(0), row.panels[0].cells.size(1)});
        return std::clamp(std::floor(wanted_side / side), 1.0, 32.0);
    }
    double widest() const {
        double out = 0;
        for (const auto& row : rows_) out = std::max(out, zoom_ * row.panels[0].cells.size(0));
        return out;
    }
    double height() const {
        double out = 0;
        for (const auto& row : rows_) out += caption + zoom_ * row.panels[0].cells.size(1);
        return out;
    }
    double left(std::size_t column) const {
        return margin + static_cast<double>(column) * (column_ + gap);
    }

    void draw_panel(const Slices& row, std::size_t column, double y) {
        const auto& panel = row.panels[column];
        const auto scale = column < 2 ? SheetRow::Scale::value : SheetRow::Scale::change;
        const auto& range = column < 2 ? value_range_ : change_range_;
        Picture pixels{panel.cells.size(0), panel.cells.size(1), {}};
        for (int up = panel.cells.last[1]; up >= panel.cells.first[1]; --up)
            for (int right = panel.cells.first[0]; right <= panel.cells.last[0]; ++right)
                pixels.pixels.push_back(colour_of(panel.at(right, up), scale, range));
        canvas_.picture({left(column), y, zoom_ * pixels.width, zoom_ * pixels.height}, pixels);
        const auto [right, up] = picture_axes(row.view);
        const int across = floor_div(voxel_[right], panel.cell) - panel.cells.first[0],
                  down = panel.cells.last[1] - floor_div(voxel_[up], panel.cell);
        // The frame stands around the voxel and hides nothing of it.
        canvas_.outline(
            {left(column) + across * zoom_ - 2, y + down * zoom_ - 2, zoom_ + 4, zoom_ + 4}, bright,
            false);
    }

    void draw_scale(const Canvas::Rect& rect, SheetRow::Scale scale, const ScaleRange& range) {
        Picture ramp{static_cast<int>(rect.width), 1, {}};
        const auto value = [&](double share) {
            return range.low + (range.high - range.low) * share;
        };
        for (int x = 0; x < ramp.width; ++x)
            ramp.pixels.push_back(colour_of(
                static_cast<float>(value(static_cast<double>(x) / std::max(ramp.width - 1, 1))),
                scale, range));
        canvas_.picture(rect, ramp);
        const double baseline = rect.y + rect.height + 15;
        canvas_.text(rect.x, baseline, fmt::format("{:.3g}", value(0)), plain);
        canvas_.text(rect.x + rect.width / 2, baseline, fmt::format("{:.3g}", value(0.5)), plain,
                     Canvas::Align::centre);
        canvas_.text(rect.x + rect.width, baseline, fmt::format("{:.3g}", value(1)), plain,
                     Canvas::Align::right);
    }

    const DrawnDifference& shown_;
    std::vector<Slices> rows_;
    Coord voxel_;
    double zoom_;
    double column_;
    Canvas canvas_;
    ScaleRange value_range_, change_range_;
};

}  // namespace

Canvas draw_difference(const DrawnDifference& shown) {
    Coord voxel(0);
    for (std::size_t axis = 0; axis < std::min<std::size_t>(3, shown.worst.index.size()); ++axis)
        voxel[static_cast<int>(axis)] = static_cast<int>(shown.worst.index[axis]);
    return DifferencePage(shown, slices_of(*shown.a, *shown.b, voxel), voxel).draw();
}

}  // namespace fluidcarve
