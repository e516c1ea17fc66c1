#pragma once

#include "graph/node_type.h"
#include "nodes/preview/canvas.h"
#include "nodes/preview/projection.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// What a sheet shows of one grid in one frame.
struct SheetPanel {
    openvdb::CoordBBox active;  ///< index box of the active voxels; empty: nothing to show
    Projection projection;      ///< over that box
};

struct SheetRow {
    int frame = 0;
    SheetPanel before;
    SheetPanel after;
};

struct SheetText {
    std::string grid;
    View view = View::y;
    std::size_t frames = 1;  ///< of the whole sequence
};

/// A row per frame, before and after side by side: one index window, one scale and one range of colours for all of
/// them, so that what differs on the sheet differs in the data. 560 to about 1700 pixels wide.
Canvas draw_sheet(const SheetText& text, const std::vector<SheetRow>& rows);

/// Type `preview.sheet`.
NodeType preview_sheet();

}  // namespace fluidcarve
