#include "nodes/preview/panel_layout.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

constexpr double page_height = 1500;  // wanted height of all panels together
constexpr double shortest = 240;
constexpr double tallest = 640;
constexpr double largest_voxel = 24;
constexpr double clear =
    220;  // a panel with a side of this length is large enough: do not wrap frames to enlarge it

}  // namespace

PanelLayout::PanelLayout(const Area& area, int cell, std::size_t frames, std::size_t rows,
                         double beside)
    : cell_(cell), beside_(beside) {
    const double longer = std::max(area.size(0), area.size(1));
    double best = 0;
    for (std::size_t bands = 1; bands <= frames; ++bands) {
        const auto across = (frames + bands - 1) / bands;
        if (room(across) < least_column && across > 1) continue;
        const double scale = fit(area, across, bands * rows);
        if (scale > best) best = scale, across_ = across, bands_ = (frames + across - 1) / across;
        if (best * longer >= clear) break;
    }
    while (best * cell_ < 1) cell_ *= 2;
    cells_ = in_cells(area, cell_);
    const double widest = room(across_) / cells_.size(0);
    zoom_ = std::min(best * cell_, widest);
    // An integer zoom keeps voxels square and sharp.
    if (zoom_ >= 2) zoom_ = std::round(zoom_) <= widest ? std::round(zoom_) : std::floor(zoom_);

    const auto inner = picture(0, 0);
    const auto columns = static_cast<double>(across_);
    column_ = std::max(
        {inner.width, least_column, (least_page - beside - (columns - 1) * gap) / columns});
    row_ = std::max(inner.height, least_row);
}

double PanelLayout::room(std::size_t across) const {
    const auto columns = static_cast<double>(across);
    return (widest_page - beside_ - (columns - 1) * gap) / columns;
}

double PanelLayout::fit(const Area& area, std::size_t across, std::size_t panels_down) const {
    const double height =
        std::clamp(page_height / static_cast<double>(panels_down), shortest, tallest);
    return std::min({room(across) / area.size(0), height / area.size(1), largest_voxel});
}

Canvas::Rect PanelLayout::picture(double x, double y) const {
    const double width = std::max(std::floor(cells_.size(0) * zoom_ + 1e-6), 1.0);
    const double height = std::max(std::floor(cells_.size(1) * zoom_ + 1e-6), 1.0);
    return {x + std::max(std::round((column_ - width) / 2), 0.0),
            y + std::max(std::round((row_ - height) / 2), 0.0), width, height};
}

Canvas::Rect PanelLayout::place(const Canvas::Rect& picture, const Area& area) const {
    const double left = std::round(right(picture, area.first[0]));
    const double top = std::round(up(picture, area.last[1] + 1));
    return {left, top, std::round(right(picture, area.last[0] + 1)) - left,
            std::round(up(picture, area.first[1])) - top};
}

}  // namespace fluidcarve
