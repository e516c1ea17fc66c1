#pragma once

#include "nodes/preview/canvas.h"
#include "nodes/preview/view.h"

namespace fluidcarve {

/// A rendered picture of an area. A voxel is a whole number of pixels, or a pixel a whole number of
/// voxels.
struct RenderedPicture {
    static constexpr int most_pixels = 400;  ///< on the longer side
    Area area;                               ///< in voxels
    Picture picture;                         ///< empty: nothing is rendered
    bool empty() const { return picture.pixels.empty(); }
};

/// Background colour of a render.
constexpr Colour render_background{74, 81, 94};

}  // namespace fluidcarve
