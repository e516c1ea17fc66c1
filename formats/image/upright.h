#pragma once

#include "formats/image/image.h"

#include <openvdb/Types.h>

namespace fluidcarve {

/// Maps pixels of a file to voxels of the upright picture: y up, its lower left corner at `low`.
/// Cameras store pictures as the camera was held, with an orientation that tells how to turn them.
class Upright {
public:
    /// @param orientation  as in TIFF and Exif, 1 to 8; other values count as 1, upright
    /// @param display      display window of the file
    Upright(int orientation, const Image::Window& display,
            const openvdb::Coord& low = openvdb::Coord(0));

    openvdb::Coord voxel(int x, int y) const;
    openvdb::CoordBBox voxels(const Image::Window& window) const;
    Image::Window window(const openvdb::CoordBBox& voxels) const;
    /// Size of the upright picture, pixels.
    int width() const { return width_; }
    int height() const { return height_; }

private:
    bool swap_, flip_x_, flip_y_;
    Image::Window display_;
    openvdb::Coord low_;
    int width_, height_;
};

/// Width and height of a turned picture: converts from stored to upright, and from upright to
/// stored.
std::array<int, 2> turned_size(int orientation, int width, int height);

}  // namespace fluidcarve
