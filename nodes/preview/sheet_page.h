#pragma once

#include "nodes/preview/canvas.h"
#include "nodes/preview/overlay.h"
#include "nodes/preview/projection.h"
#include "nodes/preview/render.h"
#include "nodes/preview/seam_lines.h"

#include <array>
#include <string>
#include <vector>

namespace fluidcarve {

/// One picture of a sheet.
struct SheetPanel {
    std::string caption;    ///< text above the picture
    Area active;            ///< box of active voxels, drawn as a solid line; may be empty
    Area before;            ///< box of active voxels before the carve, drawn dashed; may be empty
    Projection projection;  ///< a panel has either a projection or a render; the other is empty
    RenderedPicture render;
    std::vector<PictureLine> lattice, rig, seams;  ///< lines drawn over the picture, in this order
    std::string note;                              ///< text in the middle of the picture
};

/// A row of pictures of one kind, with one panel per frame.
struct SheetRow {
    /// The colour scale. All rows with the same scale share its range: `value` and `energy` from 0,
    /// or from the smallest value if that is negative, to the greatest; `change` symmetric around
    /// 0. Renders have no scale (`none`).
    enum class Scale { value, change, energy, none };
    std::string name;
    std::string what;  ///< what the row shows: "slice at y = 22"
    Scale scale = Scale::value;
    std::vector<SheetPanel> panels;
};

/// The content of a sheet.
struct SheetPage {
    std::string title;
    std::string summary;
    std::array<SeenDirection, 3> axes{};  ///< the world's x, y and z, drawn at the upper right
    std::vector<std::string> frames;      ///< titles of the columns, at least one
    std::vector<SheetRow> rows;           ///< at least one
    std::string seams = "seams";          ///< what the legend calls them
};

/// The range of one scale over all rows.
struct ScaleRange {
    double low = 0;
    double high = 1;
};
ScaleRange range_of(const std::vector<SheetRow>& rows, SheetRow::Scale scale);
/// The colour of a value; NaN has the colour for "no active voxel".
Colour colour_of(float value, SheetRow::Scale scale, const ScaleRange& range);

/// The colours of seams, lattice and rig; no colour scale contains them.
constexpr Colour seam_colour{64, 255, 208};
constexpr Colour lattice_colour{198, 128, 255};
constexpr Colour rig_colour{168, 240, 64};
/// The colours of the world's axes x, y and z.
constexpr std::array<Colour, 3> axis_colours{{{226, 84, 76}, {112, 196, 88}, {92, 148, 246}}};

/// Draws a sheet, 560 to 2000 pixels wide, with one column per frame. All panels show the same
/// area, so that pictures can be compared: the content, and the lattice and the rig, but of these
/// no more than the size of the content on each side. Beside each group of rows with the same
/// scale is its colour bar with numbers.
Canvas draw_sheet(const SheetPage& page);

}  // namespace fluidcarve
