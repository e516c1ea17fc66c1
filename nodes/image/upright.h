#pragma once

#include "nodes/image/image.h"

#include <openvdb/Types.h>

namespace fluidcarve {

/// Where the pixels of a file stand as voxels: upright, y up, the picture's lower left corner at `low`. Cameras store what they
/// see as they are held, and say with it how to turn it.
class Upright {
public:
    /// @param orientation  of TIFF and Exif, 1 to 8; others mean 1, as it is
    Upright(int orientation, const Image::Window& display, const openvdb::Coord& low = openvdb::Coord(0));

    openvdb::Coord voxel(int x, int y) const;
    openvdb::CoordBBox voxels(const Image::Window& window) const;
    Image::Window window(const openvdb::CoordBBox& voxels) const;
    /// Of the picture once it is upright.
    int width() const { return width_; }
    int height() const { return height_; }

private:
    bool swap_, flip_x_, flip_y_;
    Image::Window display_;
    openvdb::Coord low_;
    int width_, height_;
};

/// Width and height as a file stores what is upright, or the other way round.
std::array<int, 2> turned_size(int orientation, int width, int height);

}  // namespace fluidcarve
