#pragma once

#include "nodes/payloads.h"

#include <array>

namespace fluidcarve {

/// The axis along which one looks. The picture's right and up are, for x: y and z (seen from +x), for y: x and z
/// (seen from -y), for z: x and y (seen from +z).
enum class View { x, y, z };

/// Index axes of a picture's right and up.
std::array<int, 2> picture_axes(View view);

/// A rectangle of a picture's plane in whole voxels, both ends inside.
struct Window {
    std::array<int, 2> first{0, 0};  ///< right, up
    std::array<int, 2> last{-1, -1};

    bool empty() const { return last[0] < first[0] || last[1] < first[1]; }
    int size(int side) const { return last[side] - first[side] + 1; }
    void include(const Window& other);
};

/// The face of an index box that the view shows.
Window window_of(const openvdb::CoordBBox& box, View view);

/// A grid's greatest value along each line of sight, in cells of `cell` x `cell` voxels (0 is a cell's lower border).
struct Projection {
    int cell = 1;
    Window cells;               ///< in cells
    std::vector<float> values;  ///< rows from the bottom up; NaN: nothing active there

    float at(int right, int up) const { return values[static_cast<std::size_t>(up - cells.first[1]) * cells.size(0) + (right - cells.first[0])]; }
};

/// Maximum projection of the active values (of a vector grid: of their lengths) in an index box; NaN values are passed over.
/// @param box   at least one voxel large
/// @param most  cells that the picture may have on a side; a larger box is seen through cells of 2, 4, ... voxels
Projection maximum_projection(const FloatGrid& grid, View view, const openvdb::CoordBBox& box, int most = 1024);
Projection maximum_projection(const VectorGrid& grid, View view, const openvdb::CoordBBox& box, int most = 1024);

/// The same in cells of `cell` voxels, a multiple of the projection's own, over a window in such cells.
Projection fitted(const Projection& projection, int cell, const Window& cells);

}  // namespace fluidcarve
