#pragma once

#include "nodes/preview/canvas.h"
#include "nodes/preview/projection.h"
#include "nodes/preview/render.h"
#include "nodes/preview/seam_lines.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// One picture of a sheet.
struct SheetPanel {
    std::string caption;             ///< above it
    Area active;                     ///< in voxels, drawn as a solid line; may be empty
    Area before;                     ///< the same, dashed
    Projection projection;           ///< empty: nothing to show
    Render render;                   ///< the same; a panel has one of both
    std::vector<PictureLine> seams;  ///< drawn over it
    std::string note;                ///< in its middle
};

/// All pictures of one kind, a panel per frame.
struct SheetRow {
    /// Rows of one scale share its range and colours: `value` and `energy` from 0, or the least value if that is below,
    /// to the greatest; `change` to both sides of 0 alike. `none` is for renders, which have colours of their own.
    enum class Scale { value, change, energy, none };
    std::string name;
    std::string what;  ///< "slice at y = 22"
    Scale scale = Scale::value;
    std::vector<SheetPanel> panels;
};

struct SheetPage {
    std::string title;
    std::string summary;
    View view = View::y;
    std::vector<std::string> frames;  ///< heads of the columns, at least one
    std::vector<SheetRow> rows;       ///< at least one
};

/// The range of one scale over all rows.
struct ScaleRange {
    double low = 0;
    double high = 1;
};
ScaleRange range_of(const std::vector<SheetRow>& rows, SheetRow::Scale scale);
/// The colour of a value; NaN: that of no active voxel.
Colour colour_of(float value, SheetRow::Scale scale, const ScaleRange& range);

/// The colour of seams, which no scale holds.
constexpr Colour seam_colour{64, 255, 208};

/// Draws a sheet, 560 to 2000 pixels wide: a column per frame, and one window for all panels, so that what differs on the
/// sheet differs in the data. Beside each run of rows of one scale stand its colours with numbers.
Canvas draw_sheet(const SheetPage& page);

}  // namespace fluidcarve
