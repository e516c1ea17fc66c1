#pragma once

#include "nodes/preview/canvas.h"
#include "nodes/preview/projection.h"

#include <cstddef>

namespace fluidcarve {

/// The arrangement of a sheet's panels, and the scale of their pictures, which is the same in all.
/// Frames go across, rows down; frames that do not fit side by side wrap into bands. Lengths in
/// pixels.
class PanelLayout {
public:
    static constexpr double least_page = 560;
    static constexpr double widest_page = 2000;
    static constexpr double least_column = 150;  ///< room for the labels above a panel
    static constexpr double least_row = 104;     ///< room for the labels beside a panel
    static constexpr double gap = 10;            ///< between columns

    /// @param area    the area that each panel shows, voxels
    /// @param cell    size of a cell in the coarsest projection, voxels
    /// @param frames, rows  numbers of columns and rows of panels, at least 1
    /// @param beside  width of the page without the panels, pixels
    PanelLayout(const Area& area, int cell, std::size_t frames, std::size_t rows, double beside);

    const Area& cells() const { return cells_; }  ///< area of a panel's picture, in cells
    int cell() const { return cell_; }            ///< size of a cell, voxels
    double zoom() const { return zoom_; }         ///< pixels per cell
    std::size_t across() const { return across_; }
    std::size_t bands() const { return bands_; }
    double column() const { return column_; }  ///< width of a panel
    double row() const { return row_; }        ///< height of a panel
    double page_width() const {
        return beside_ + static_cast<double>(across_) * (column_ + gap) - gap;
    }

    /// The picture's rectangle inside a panel with the upper left corner (x, y).
    Canvas::Rect picture(double x, double y) const;
    /// Page coordinates of a position in voxels, in a picture.
    double right(const Canvas::Rect& picture, double voxels) const {
        return picture.x + (voxels / cell_ - cells_.first[0]) * zoom_;
    }
    double up(const Canvas::Rect& picture, double voxels) const {
        return picture.y + picture.height - (voxels / cell_ - cells_.first[1]) * zoom_;
    }
    /// The rectangle of an area in voxels, in a picture, rounded to pixels.
    Canvas::Rect place(const Canvas::Rect& picture, const Area& area) const;

private:
    /// Pixels per voxel for this number of panels side by side and below each other.
    double fit(const Area& area, std::size_t across, std::size_t panels_down) const;
    double room(std::size_t across) const;

    Area cells_;
    int cell_;
    double zoom_ = 1;
    std::size_t across_ = 1, bands_ = 1;
    double column_ = 0, row_ = 0;
    double beside_;
};

}  // namespace fluidcarve
