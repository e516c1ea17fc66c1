#include "nodes/preview/sheet.h"

#include "graph/output_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

template <>
struct ChoiceNames<View> {
    static constexpr std::array names = {std::pair{"x", View::x}, std::pair{"y", View::y}, std::pair{"z", View::z}};
};

namespace {

constexpr Colour page{30, 31, 35};
constexpr Colour nothing{16, 16, 20};  // not a colour of the scale: no active voxel
constexpr Colour bright{238, 238, 238};
constexpr Colour dim{150, 155, 163};
constexpr Colour frame_line{84, 112, 132};
constexpr Canvas::Type title{20, true, bright};
constexpr Canvas::Type heading{14, true, bright};
constexpr Canvas::Type plain{12, false, dim};

constexpr double margin = 20;
constexpr double gutter = 12;  // between panels
constexpr double header = 92;  // title, range, names of the columns
constexpr double strip = 24;   // above each panel
constexpr double footer = 26;
constexpr double widest_panel = 820;
constexpr double least_page = 560;
constexpr double row_heights = 1500;  // of all panels together, where the count of rows allows
constexpr double row_least = 200;
constexpr double row_most = 760;

struct Scale {
    double low = 0;
    double high = 1;
    Colour colour(float value) const { return std::isnan(value) ? nothing : heat((value - low) / (high - low)); }
};

/// From 0 to the greatest value, or from the least where that is negative.
Scale scale_of(const std::vector<SheetRow>& rows) {
    Scale out{0, 0};
    for (const auto& row : rows)
        for (const auto* panel : {&row.before, &row.after})
            for (const float value : panel->projection.values)
                if (std::isfinite(value)) {
                    out.low = std::min(out.low, static_cast<double>(value));
                    out.high = std::max(out.high, static_cast<double>(value));
                }
    if (out.low == out.high) out.high = 1;
    return out;
}

/// Where panels stand and how large a cell is drawn.
struct Arrangement {
    Window window;  ///< in voxels
    Window cells;
    int cell = 1;      ///< voxels
    double zoom = 1;   ///< pixels per cell
    double width = 0;  ///< of a panel's picture
    double height = 0;
    double column = 0;  ///< of a panel with its labels

    Arrangement(const std::vector<SheetRow>& rows, View view) {
        for (const auto& row : rows)
            for (const auto* panel : {&row.before, &row.after})
                if (!panel->active.empty()) {
                    window.include(window_of(panel->active, view));
                    cell = std::max(cell, panel->projection.cell);
                }
        if (window.empty()) window = {{0, 0}, {31, 3}};
        const double tallest = std::clamp(row_heights / static_cast<double>(rows.size()), row_least, row_most);
        const auto fit = [&] { return std::min(widest_panel * cell / window.size(0), tallest * cell / window.size(1)); };
        while (fit() < 1) cell *= 2;
        // Whole steps keep voxels square and sharp, unless they would waste much of the place.
        zoom = fit() >= 3 ? std::floor(fit()) : fit();
        for (const int side : {0, 1}) {
            cells.first[side] = static_cast<int>(std::floor(static_cast<double>(window.first[side]) / cell));
            cells.last[side] = static_cast<int>(std::floor(static_cast<double>(window.last[side]) / cell));
        }
        width = std::round(cells.size(0) * zoom);
        height = std::round(cells.size(1) * zoom);
        column = std::max(width, (least_page - 2 * margin - gutter) / 2);
    }

    double page_width() const { return 2 * column + 2 * margin + gutter; }
    /// Of an index box inside a panel.
    Canvas::Rect place(const Window& box, double x, double y) const {
        const double step = zoom / cell;
        const double left = (box.first[0] - cells.first[0] * cell) * step;
        const double bottom = (box.first[1] - cells.first[1] * cell) * step;
        const double wide = box.size(0) * step;
        const double high = box.size(1) * step;
        return {std::round(x + left), std::round(y + height - bottom - high), std::round(wide), std::round(high)};
    }
};

Picture picture_of(const Projection& projection, const Scale& scale) {
    Picture out{projection.cells.size(0), projection.cells.size(1), {}};
    for (int y = projection.cells.last[1]; y >= projection.cells.first[1]; --y)
        for (int x = projection.cells.first[0]; x <= projection.cells.last[0]; ++x) out.pixels.push_back(scale.colour(projection.at(x, y)));
    return out;
}

std::string number(double value) { return fmt::format("{:.4g}", value); }

const char* name_of(View view) { return ChoiceNames<View>::names[static_cast<std::size_t>(view)].first; }

void draw_header(Canvas& canvas, const SheetText& text, const Arrangement& layout, const Scale& scale, std::size_t rows) {
    canvas.text(margin, 36, text.grid, title);
    canvas.text(margin, 56, fmt::format("maximum along {}; {} of {} frame{}", name_of(text.view), rows, text.frames, text.frames == 1 ? "" : "s"), plain);

    constexpr double wide = 160;
    const Canvas::Rect bar{layout.page_width() - margin - wide, 22, wide, 14};
    Picture ramp{static_cast<int>(wide), 1, {}};
    for (int x = 0; x < ramp.width; ++x) ramp.pixels.push_back(heat(x / (wide - 1)));
    canvas.picture(bar, ramp);
    canvas.text(bar.x, 56, number(scale.low), plain);
    canvas.text(bar.x + bar.width, 56, number(scale.high), plain, Canvas::Align::right);

    canvas.text(margin, header - 8, "before", heading);
    canvas.text(margin + layout.column + gutter, header - 8, "after", heading);
}

void draw_panel(Canvas& canvas, const SheetPanel& panel, const SheetPanel* other, const SheetText& text, const Arrangement& layout, const Scale& scale,
                double x, double y) {
    const Canvas::Rect whole{x, y, layout.column, layout.height};
    canvas.fill(whole, nothing);
    const double left = x + std::round((layout.column - layout.width) / 2);
    if (other && !other->active.empty()) canvas.outline(layout.place(window_of(other->active, text.view), left, y), dim, true);
    if (panel.active.empty()) return canvas.text(x + layout.column / 2, y + layout.height / 2, "no active voxels", plain, Canvas::Align::centre);
    canvas.picture({left, y, layout.width, layout.height}, picture_of(fitted(panel.projection, layout.cell, layout.cells), scale));
    if (other && !other->active.empty()) canvas.outline(layout.place(window_of(other->active, text.view), left, y), dim, true);
    canvas.outline(layout.place(window_of(panel.active, text.view), left, y), frame_line, false);
}

std::string size_text(const SheetPanel& panel) {
    if (panel.active.empty()) return {};
    const auto size = panel.active.dim();
    return fmt::format("{} x {} x {} voxels", size.x(), size.y(), size.z());
}

/// Frames that a sheet shows: the first, the last and between them in even steps; one alone is the middle one.
bool shown(std::size_t place, std::size_t total, int wanted) {
    const auto count = std::min(total, static_cast<std::size_t>(wanted));
    if (count <= 1) return place == total / 2;
    for (std::size_t n = 0; n < count; ++n)
        if ((2 * n * (total - 1) + count - 1) / (2 * (count - 1)) == place) return true;
    return false;
}

struct Sheet {
    struct Params {
        std::string grid = "density";
        View axis = View::y;
        int frames = 3;
        OutputPath path;
    };
    struct Ports {
        Ref<Volume> before;
        Ref<Volume> after;
    };

    static bool wants(const Params& params, const Context& context) { return shown(context.place(), context.frames().size(), params.frames); }

    void add(const Params& params, const Ports& io, Context& context) {
        if (!wants(params, context)) return;
        const auto before = grid_of(*io.before, "before", params.grid);
        const auto after = grid_of(*io.after, "after", params.grid);
        if (before->transform() != after->transform())
            context.warn(fmt::format("'{}' has another transform in 'after' than in 'before'; the sheet compares them voxel by voxel", params.grid));
        rows.push_back({context.frame(), panel_of(*before, params), panel_of(*after, params)});
        total = context.frames().size();
    }

    void finish(const Params& params, Ports&, Context& context) {
        OutputFile file(params.path.at(context.frame()));
        draw_sheet({params.grid, params.axis, total}, rows).write_png(file.aside());
        file.commit();
    }

private:
    static openvdb::GridBase::ConstPtr grid_of(const Volume& volume, const char* input, const std::string& name) {
        const auto grid = volume.find(name);
        std::vector<std::string> names;
        for (const auto& each : volume.grids) names.push_back(each->getName());
        if (!grid) throw Failure(fmt::format("'{}' has no grid '{}'{}", input, name, did_you_mean(name, names)));
        if (!grid->isType<FloatGrid>() && !grid->isType<VectorGrid>())
            throw Failure(fmt::format("grid '{}' of '{}' holds {} values; a sheet shows grids of floats or vectors", name, input, grid->valueType()));
        return grid;
    }

    static SheetPanel panel_of(const openvdb::GridBase& grid, const Params& params) {
        SheetPanel out;
        out.active = grid.evalActiveVoxelBoundingBox();
        if (out.active.empty()) return out;
        if (grid.isType<FloatGrid>()) out.projection = maximum_projection(static_cast<const FloatGrid&>(grid), params.axis, out.active);
        else out.projection = maximum_projection(static_cast<const VectorGrid&>(grid), params.axis, out.active);
        return out;
    }

    std::vector<SheetRow> rows;
    std::size_t total = 1;
};

}  // namespace

Canvas draw_sheet(const SheetText& text, const std::vector<SheetRow>& rows) {
    const Arrangement layout(rows, text.view);
    const auto scale = scale_of(rows);
    const double row_height = strip + layout.height + gutter;
    Canvas canvas(static_cast<int>(layout.page_width()), static_cast<int>(header + row_height * static_cast<double>(rows.size()) + footer), page);
    draw_header(canvas, text, layout, scale, rows.size());
    double y = header;
    for (const auto& row : rows) {
        double x = margin;
        for (const auto* panel : {&row.before, &row.after}) {
            canvas.text(x, y + strip - 7, fmt::format("frame {}", row.frame), {12, true, bright});
            canvas.text(x + layout.column, y + strip - 7, size_text(*panel), plain, Canvas::Align::right);
            draw_panel(canvas, *panel, panel == &row.after ? &row.before : nullptr, text, layout, scale, x, y + strip);
            x += layout.column + gutter;
        }
        y += row_height;
    }
    canvas.text(margin, y + 8, "line: box of the active voxels; dashed: that of 'before'", plain);
    return canvas;
}

NodeType preview_sheet() {
    return Declare<Sheet>("preview.sheet", "A picture that shows a grid before and after, for some frames of the sequence: is the carve where it should be?")
        .input("before", &Sheet::Ports::before, "Usually what was read.")
        .input("after", &Sheet::Ports::after, "Usually what is written; shown in the same window and colours as `before`.")
        .param("grid", &Sheet::Params::grid, "Name of the grid to show, in both volumes; of vectors, their length is shown.")
        .param("axis", &Sheet::Params::axis,
               "Direction of view: each pixel is the greatest value along this axis of the grid. Up is z, or y where the view is along z.")
        .param("frames", &Sheet::Params::frames, Unit::frames, between(1, 12), "How many to show, evenly from the first to the last; 1 shows the middle one.")
        .required("path", &Sheet::Params::path, "PNG file, one for the whole sequence. Folders are made.");
}

}  // namespace fluidcarve
