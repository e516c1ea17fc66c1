#pragma once

#include "nodes/preview/canvas.h"
#include "nodes/preview/projection.h"

#include <cstddef>

namespace fluidcarve {

/// How the panels of a sheet are arranged and how large a voxel is drawn: the same in all of them. Frames go across,
/// rows down; frames that do not fit side by side go into bands below each other. Lengths in pixels.
class PanelLayout {
public:
    static constexpr double least_page = 560;
    static constexpr double widest_page = 2000;
    static constexpr double least_column = 150;  ///< room for the labels above a panel
    static constexpr double least_row = 104;     ///< room for those beside it
    static constexpr double gap = 10;            ///< between columns

    /// @param area    what each panel shows
    /// @param cell    voxels; the coarsest projection shown, so that none is shown finer than it is
    /// @param frames, rows  at least 1
    /// @param beside  width of the page that is not panels
    PanelLayout(const Area& area, int cell, std::size_t frames, std::size_t rows, double beside);

    const Area& cells() const { return cells_; }  ///< of a panel's picture
    int cell() const { return cell_; }            ///< voxels
    double zoom() const { return zoom_; }         ///< pixels per cell
    std::size_t across() const { return across_; }
    std::size_t bands() const { return bands_; }
    double column() const { return column_; }  ///< width of a panel
    double row() const { return row_; }        ///< height of a panel
    double page_width() const { return beside_ + static_cast<double>(across_) * (column_ + gap) - gap; }

    /// The picture inside a panel with this upper left corner.
    Canvas::Rect picture(double x, double y) const;
    /// A point in voxels inside that picture.
    double right(const Canvas::Rect& picture, double voxels) const { return picture.x + (voxels / cell_ - cells_.first[0]) * zoom_; }
    double up(const Canvas::Rect& picture, double voxels) const { return picture.y + picture.height - (voxels / cell_ - cells_.first[1]) * zoom_; }
    /// An area inside that picture, on whole pixels.
    Canvas::Rect place(const Canvas::Rect& picture, const Area& area) const;

private:
    /// Pixels per voxel if so many frames stand side by side.
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
