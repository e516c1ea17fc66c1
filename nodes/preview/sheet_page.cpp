#include "nodes/preview/sheet_page.h"

#include "carve/field/extent.h"
#include "nodes/preview/panel_layout.h"
#include "nodes/preview/sheet_style.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace fluidcarve {

namespace {

using namespace sheet_style;

constexpr Colour nothing{16, 16, 20};  // no active voxel; not a colour of a scale
constexpr Colour active_line{84, 112, 132};
constexpr Colour before_line{150, 155, 163};
constexpr double label = 128;  // width of the names of rows
constexpr double numbers = 62;
constexpr double bar = 12;
constexpr double panels_left = margin + label + 8 + numbers + 6 + bar + 10;
constexpr double header = 68;
constexpr double band_head = 24;  // height of the names of frames
constexpr double caption = 22;
constexpr double row_gap = 8;
constexpr double band_gap = 22;
constexpr double line_height = 16;
constexpr double axes_side = 64;  // side of the drawing of the world's axes
constexpr double axis_length = 20;
constexpr double least_slant =
    0.25;  // an axis whose part across the view is shorter than this runs along it

/// Draws a SheetPage onto a canvas.
class Drawing {
public:
    Drawing(const SheetPage& page, const PanelLayout& layout)
        : page_(page),
          layout_(layout),
          canvas_(static_cast<int>(std::ceil(layout.page_width())), static_cast<int>(height()),
                  paper) {
        for (const auto scale : {SheetRow::Scale::value, SheetRow::Scale::change,
                                 SheetRow::Scale::energy, SheetRow::Scale::none})
            ranges_.push_back(range_of(page.rows, scale));
    }

    Canvas draw() {
        const double room = canvas_.width() - 2 * margin - axes_side;
        canvas_.text(margin, 36, canvas_.fitting(page_.title, title, room), title);
        canvas_.text(margin, 56, canvas_.fitting(page_.summary, plain, room), plain);
        draw_axes(std::round(canvas_.width() - margin - axes_side / 2), header / 2 + 4);
        double y = header;
        for (std::size_t band = 0; band < layout_.bands(); ++band) {
            draw_band(band * layout_.across(), y);
            y += band_height() + band_gap;
        }
        draw_legend(y - band_gap + 18);
        return std::move(canvas_);
    }

private:
    double head_of(const SheetRow& row) const {
        const bool captions = std::ranges::any_of(
            row.panels, [](const SheetPanel& panel) { return !panel.caption.empty(); });
        return captions ? caption : row_gap;
    }
    double band_height() const {
        double out = band_head;
        for (const auto& row : page_.rows) out += head_of(row) + layout_.row();
        return out;
    }
    double height() const {
        const auto bands = static_cast<double>(layout_.bands());
        return header + bands * (band_height() + band_gap) - band_gap + 32;
    }
    const ScaleRange& range(const SheetRow& row) const {
        return ranges_[static_cast<std::size_t>(row.scale)];
    }

    void draw_band(std::size_t first, double y) {
        const auto last = std::min(first + layout_.across(), page_.frames.size());
        for (auto frame = first; frame < last; ++frame)
            canvas_.text(left_of(frame - first), y + 16, page_.frames[frame], heading);
        y += band_head;
        double bar_top = 0;
        for (std::size_t n = 0; n < page_.rows.size(); ++n) {
            const auto& row = page_.rows[n];
            y += head_of(row);
            if (n == 0 || page_.rows[n - 1].scale != row.scale) bar_top = y;
            draw_label(row, y);
            for (auto frame = first; frame < last; ++frame)
                draw_panel(row, row.panels[frame], left_of(frame - first), y);
            y += layout_.row();
            if (n + 1 == page_.rows.size() || page_.rows[n + 1].scale != row.scale)
                draw_bar(row, bar_top, y);
        }
    }

    double left_of(std::size_t column) const {
        return panels_left + static_cast<double>(column) * (layout_.column() + PanelLayout::gap);
    }

    void draw_label(const SheetRow& row, double y) {
        double line = y + 12;
        for (const auto& text : wrapped(row.name, heading, label))
            canvas_.text(margin, line, text, heading), line += line_height + 2;
        for (const auto& text : wrapped(row.what, plain, label))
            canvas_.text(margin, line, text, plain), line += line_height;
    }

    void draw_bar(const SheetRow& row, double top, double bottom) {
        if (row.scale == SheetRow::Scale::none) return;
        const Canvas::Rect rect{panels_left - 10 - bar, top, bar, bottom - top};
        const auto& [low, high] = range(row);
        Picture ramp{1, static_cast<int>(rect.height), {}};
        for (int y = 0; y < ramp.height; ++y)
            ramp.pixels.push_back(colour_of(
                static_cast<float>(high - (high - low) * y / std::max(ramp.height - 1, 1)),
                row.scale, range(row)));
        canvas_.picture(rect, ramp);
        const int steps = rect.height >= 200 ? 4 : 2;
        for (int n = 0; n <= steps; ++n) {
            const double y = std::round(bottom - (rect.height - 1) * n / steps);
            canvas_.fill({rect.x - 4, y - 1, 4, 1}, dim);
            const double baseline = std::clamp(y + 4, top + 10, bottom);
            canvas_.text(rect.x - 6, baseline,
                         fmt::format("{:.3g}", low + (high - low) * n / steps), plain,
                         Canvas::Align::right);
        }
    }

    void draw_panel(const SheetRow& row, const SheetPanel& panel, double x, double y) {
        const Canvas::Rect whole{x, y, layout_.column(), layout_.row()};
        const auto picture = layout_.picture(x, y);
        canvas_.text(x, y - 7, canvas_.fitting(panel.caption, plain, layout_.column()), plain);
        canvas_.fill(whole, row.scale == SheetRow::Scale::none ? render_background : nothing);
        if (!panel.render.empty())
            canvas_.picture(layout_.place(picture, panel.render.area), panel.render.picture,
                            Canvas::Enlarge::smoothly);
        if (!panel.projection.empty()) {
            const auto shown = fitted(panel.projection, layout_.cell(), layout_.cells());
            Picture pixels{shown.cells.size(0), shown.cells.size(1), {}};
            for (int up = shown.cells.last[1]; up >= shown.cells.first[1]; --up)
                for (int right = shown.cells.first[0]; right <= shown.cells.last[0]; ++right)
                    pixels.pixels.push_back(colour_of(shown.at(right, up), row.scale, range(row)));
            canvas_.picture(picture, pixels);
        }
        if (!panel.before.empty())
            canvas_.outline(layout_.place(picture, panel.before), before_line, true);
        if (!panel.active.empty())
            canvas_.outline(layout_.place(picture, panel.active), active_line, false);
        const double width = std::clamp(std::floor(layout_.zoom()) / 2 - 0.5, 1.0, 2.0);
        canvas_.lines(whole, on_page(panel.lattice, picture), width, lattice_colour);
        // A dark outline separates drawn lines from bright energy and smoke.
        for (const auto& [drawn, colour] :
             {std::pair(&panel.rig, rig_colour), std::pair(&panel.seams, seam_colour)}) {
            const auto lines = on_page(*drawn, picture);
            canvas_.lines(whole, lines, width + 1.5, nothing);
            canvas_.lines(whole, lines, width, colour);
        }
        if (!panel.note.empty())
            canvas_.text(x + layout_.column() / 2, y + layout_.row() / 2 + 4, panel.note, plain,
                         Canvas::Align::centre);
    }

    std::vector<Canvas::Line> on_page(const std::vector<PictureLine>& lines,
                                      const Canvas::Rect& picture) const {
        std::vector<Canvas::Line> out;
        for (const auto& [from, to] : lines)
            out.push_back({layout_.right(picture, from[0]), layout_.up(picture, from[1]),
                           layout_.right(picture, to[0]), layout_.up(picture, to[1])});
        return out;
    }

    /// Draws the world's axes as arrows from a place; one that runs along the view as a circle,
    /// with a dot if it points at the viewer, else with a cross.
    void draw_axes(double x, double y) {
        const Canvas::Rect page{0, 0, static_cast<double>(canvas_.width()),
                                static_cast<double>(canvas_.height())};
        for (const bool along : {false, true})  // circles come last, over the ends of the arrows
            for (std::size_t n = 0; n < page_.axes.size(); ++n) {
                const double right = page_.axes[n].right, up = page_.axes[n].up,
                             towards = page_.axes[n].towards;
                const double slant = std::hypot(right, up);
                if ((slant < least_slant) != along || (slant == 0 && towards == 0)) continue;
                const auto colour = axis_colours[n];
                const std::string name(1, "xyz"[n]);
                const Canvas::TextStyle type{12, true, colour};
                if (along) {
                    draw_circle(page, x, y, towards > 0, colour);
                    canvas_.text(x - 12, y + 15, name, type, Canvas::Align::centre);
                    continue;
                }
                const double tip_x = x + axis_length * right, tip_y = y - axis_length * up;
                const auto barb = [&](double side) {
                    return Canvas::Line{tip_x, tip_y, tip_x - (5 * right + side * up) / slant,
                                        tip_y + (5 * up - side * right) / slant};
                };
                canvas_.lines(page, {{x, y, tip_x, tip_y}, barb(3), barb(-3)}, 2, colour);
                canvas_.text(x + 1.4 * axis_length * right, y - 1.4 * axis_length * up + 4, name,
                             type, Canvas::Align::centre);
            }
    }

    void draw_circle(const Canvas::Rect& page, double x, double y, bool dotted, Colour colour) {
        constexpr double radius = 6;
        constexpr int steps = 24;
        const double turn = 2 * std::acos(-1.0) / steps;
        std::vector<Canvas::Line> lines;
        for (int n = 0; n < steps; ++n)
            lines.push_back({x + radius * std::cos(n * turn), y + radius * std::sin(n * turn),
                             x + radius * std::cos((n + 1) * turn),
                             y + radius * std::sin((n + 1) * turn)});
        if (!dotted)
            lines.insert(lines.end(), {{x - 3, y - 3, x + 3, y + 3}, {x - 3, y + 3, x + 3, y - 3}});
        canvas_.fill({x - 4, y - 4, 8, 8}, paper);
        canvas_.lines(page, lines, 2, colour);
        if (dotted) canvas_.fill({x - 2, y - 2, 4, 4}, colour);
    }

    void draw_legend(double y) {
        const auto any = [&](const auto& has) {
            return std::ranges::any_of(page_.rows, [&](const SheetRow& row) {
                return std::ranges::any_of(row.panels, has);
            });
        };
        double x = margin;
        const auto entry = [&](Colour colour, bool dashed, const std::string& text) {
            canvas_.outline({x, y - 4, 20, 1}, colour, dashed);
            canvas_.text(x + 26, y, text, plain);
            x += 26 + canvas_.text_width(text, plain) + 18;
        };
        if (any([](const SheetPanel& panel) { return !panel.active.empty(); }))
            entry(active_line, false, "box of active voxels");
        if (any([](const SheetPanel& panel) { return !panel.before.empty(); }))
            entry(before_line, true, "that of before");
        if (any([](const SheetPanel& panel) { return !panel.lattice.empty(); }))
            entry(lattice_colour, false, "lattice");
        if (any([](const SheetPanel& panel) { return !panel.rig.empty(); }))
            entry(rig_colour, false, "rig");
        if (any([](const SheetPanel& panel) { return !panel.seams.empty(); }))
            entry(seam_colour, false, page_.seams);
    }

    std::vector<std::string> wrapped(const std::string& text, const Canvas::TextStyle& type,
                                     double width) {
        std::vector<std::string> out(1);
        for (std::size_t begin = 0; begin < text.size();) {
            const auto end = std::min(text.find(' ', begin), text.size());
            const auto word = text.substr(begin, end - begin);
            const auto longer = out.back().empty() ? word : out.back() + " " + word;
            if (out.back().empty() || canvas_.text_width(longer, type) <= width)
                out.back() = longer;
            else out.push_back(word);
            begin = end + 1;
        }
        return out;
    }

    const SheetPage& page_;
    const PanelLayout& layout_;
    Canvas canvas_;
    std::vector<ScaleRange> ranges_;
};

/// The area in voxels that contains all lines.
Area around(const std::vector<PictureLine>& lines) {
    Area out;
    for (const auto& line : lines)
        for (const auto& end : {line.from, line.to}) {
            const auto near = near_place({end[0], end[1], 0});
            const std::array<int, 2> voxel{static_cast<int>(std::floor(near[0])),
                                           static_cast<int>(std::floor(near[1]))};
            out.include({voxel, voxel});
        }
    return out;
}

/// The area that contains all lines, but no further beyond the content than its size.
Area beside(const Area& content, const std::vector<PictureLine>& lines) {
    auto out = around(lines);
    if (out.empty()) return out;
    for (const int side : {0, 1}) {
        const std::int64_t reach = content.size(side);
        out.first[side] =
            static_cast<int>(std::max<std::int64_t>(out.first[side], content.first[side] - reach));
        out.last[side] =
            static_cast<int>(std::min<std::int64_t>(out.last[side], content.last[side] + reach));
    }
    return out;
}

}  // namespace

ScaleRange range_of(const std::vector<SheetRow>& rows, SheetRow::Scale scale) {
    ScaleRange out{0, 0};
    const auto take = [&](const Projection& shown) {
        for (const double value : shown.values)
            if (std::isfinite(value)) out = {std::min(out.low, value), std::max(out.high, value)};
    };
    for (const auto& row : rows)
        if (row.scale == scale)
            for (const auto& panel : row.panels) take(panel.projection);
    if (scale == SheetRow::Scale::change)
        out = {std::min(out.low, -out.high), std::max(out.high, -out.low)};
    if (out.low == out.high) out = {scale == SheetRow::Scale::change ? -1.0 : 0.0, 1};
    return out;
}

Colour colour_of(float value, SheetRow::Scale scale, const ScaleRange& range) {
    if (std::isnan(value)) return nothing;
    if (scale == SheetRow::Scale::change) return diverging(value / range.high);
    return heat((value - range.low) / (range.high - range.low));
}

Canvas draw_sheet(const SheetPage& page) {
    Area area;
    int cell = 1;
    for (const auto& row : page.rows)
        for (const auto& panel : row.panels) {
            area.include(panel.active);
            area.include(panel.before);
            area.include(around(panel.seams));
            area.include(panel.render.area);
            if (!panel.projection.empty()) cell = std::max(cell, panel.projection.cell);
        }
    if (area.empty()) area = {{0, 0}, {0, 0}};
    const auto content = area;
    for (const auto& row : page.rows)
        for (const auto& panel : row.panels)
            for (const auto* lines : {&panel.lattice, &panel.rig})
                area.include(beside(content, *lines));
    const PanelLayout layout(area, cell, page.frames.size(), page.rows.size(),
                             panels_left + margin);
    return Drawing(page, layout).draw();
}

}  // namespace fluidcarve
