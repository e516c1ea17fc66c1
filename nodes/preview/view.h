#pragma once

#include <openvdb/math/Coord.h>

#include <array>

namespace fluidcarve {

/// The axis of view. Right and up in the picture are: for x (seen from +x) y and z, for y (seen
/// from -y) x and z, for z (seen from +z) x and y.
enum class View { x, y, z };

/// Index axes of right and up in a picture.
std::array<int, 2> picture_axes(View view);

/// A rectangle in a picture, in whole voxels.
struct Area {
    std::array<int, 2> first{0, 0};   ///< lowest voxel: right, up
    std::array<int, 2> last{-1, -1};  ///< highest voxel, inclusive
    bool empty() const { return last[0] < first[0] || last[1] < first[1]; }
    int size(int side) const { return last[side] - first[side] + 1; }
    void include(const Area& other);
};

/// `a / b`, rounded down. @param b  above 0
inline int floor_div(int a, int b) { return a / b - (a % b < 0 ? 1 : 0); }
/// The area of an index box in a picture.
Area face_of(const openvdb::CoordBBox& box, View view);
/// An area in voxels, converted to the cells of `cell` x `cell` voxels that it overlaps.
Area in_cells(const Area& area, int cell);

}  // namespace fluidcarve
