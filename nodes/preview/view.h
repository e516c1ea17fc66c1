#pragma once

#include <openvdb/math/Coord.h>

#include <array>

namespace fluidcarve {

/// The axis along which one looks. The picture's right and up are, for x: y and z (seen from +x), for y: x and z
/// (seen from -y), for z: x and y (seen from +z).
enum class View { x, y, z };

/// Index axes of a picture's right and up.
std::array<int, 2> picture_axes(View view);

/// A rectangle of a picture's plane in whole voxels, both ends inside.
struct Area {
    std::array<int, 2> first{0, 0};  ///< right, up
    std::array<int, 2> last{-1, -1};
    bool empty() const { return last[0] < first[0] || last[1] < first[1]; }
    int size(int side) const { return last[side] - first[side] + 1; }
    void include(const Area& other);
};

/// `a / b`, rounded down. @param b  above 0
inline int floor_div(int a, int b) { return a / b - (a % b < 0 ? 1 : 0); }
/// The face of an index box that the view shows.
Area face_of(const openvdb::CoordBBox& box, View view);
/// The cells of `cell` x `cell` voxels that an area touches.
Area in_cells(const Area& area, int cell);

}  // namespace fluidcarve
