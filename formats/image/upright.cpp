#include "formats/image/upright.h"

namespace fluidcarve {

using openvdb::Coord;
using openvdb::CoordBBox;

std::array<int, 2> turned_size(int orientation, int width, int height) {
    return orientation >= 5 && orientation <= 8 ? std::array{height, width}
                                                : std::array{width, height};
}

Upright::Upright(int orientation, const Image::Window& display, const Coord& low)
    : swap_(orientation >= 5 && orientation <= 8),
      flip_x_(orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7),
      flip_y_(orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8),
      display_(display),
      low_(low) {
    const auto size = turned_size(orientation, display.width, display.height);
    width_ = size[0];
    height_ = size[1];
}

Coord Upright::voxel(int x, int y) const {
    x -= display_.x;
    y -= display_.y;
    if (swap_) std::swap(x, y);
    if (flip_x_) x = width_ - 1 - x;
    if (flip_y_) y = height_ - 1 - y;
    return low_ + Coord(x, height_ - 1 - y, 0);
}

CoordBBox Upright::voxels(const Image::Window& window) const {
    const auto a = voxel(window.x, window.y),
               b = voxel(window.x + window.width - 1, window.y + window.height - 1);
    return {Coord::minComponent(a, b), Coord::maxComponent(a, b)};
}

Image::Window Upright::window(const CoordBBox& voxels) const {
    const auto pixel = [&](const Coord& at) {
        int x = at.x() - low_.x(), y = height_ - 1 - (at.y() - low_.y());
        if (flip_x_) x = width_ - 1 - x;
        if (flip_y_) y = height_ - 1 - y;
        if (swap_) std::swap(x, y);
        return Coord(x + display_.x, y + display_.y, 0);
    };
    const auto a = pixel(voxels.min()), b = pixel(voxels.max());
    const auto first = Coord::minComponent(a, b), last = Coord::maxComponent(a, b);
    return {first.x(), first.y(), last.x() - first.x() + 1, last.y() - first.y() + 1};
}

}  // namespace fluidcarve
