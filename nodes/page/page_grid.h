#pragma once

#include "carve/volume/volume.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// The voxels of a page: cubes of `step` voxels of a grid. Page voxel `c` is centred at the grid's
/// index `first + step c + (step - 1) / 2`.
struct PageGrid {
    openvdb::math::Transform::ConstPtr space;  ///< of the grid shown; linear
    openvdb::Coord first;                      ///< lowest voxel of the grid
    int step = 1;
    std::array<int, 3> size{};  ///< page voxels along x, y and z

    std::size_t count() const {
        return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
               static_cast<std::size_t>(size[2]);
    }
    /// Index coordinates of a place in page voxels.
    openvdb::Vec3d index(const openvdb::Vec3d& at) const {
        return first.asVec3d() + openvdb::Vec3d((step - 1) / 2.0) + step * at;
    }
    openvdb::Vec3d world(const openvdb::Vec3d& at) const { return space->indexToWorld(index(at)); }
    /// The place of a world position, in page voxels.
    openvdb::Vec3d place(const openvdb::Vec3d& world) const {
        return (space->worldToIndex(world) - index(openvdb::Vec3d(0))) / step;
    }
};

/// The page voxels around an index box.
/// @param box     not empty
/// @param voxels  most page voxels along an axis
PageGrid page_grid(openvdb::math::Transform::ConstPtr space, const openvdb::CoordBBox& box,
                   int voxels);

/// The values of a grid in the page's voxels, `[z][y][x]`: means over each cube; of a grid with
/// another transform, the values at the centres. Of vectors the length. Values that are not finite
/// count as 0.
/// @throws Failure if the grid holds neither floats nor vectors of floats
std::vector<float> page_values(const openvdb::GridBase& grid, const PageGrid& page);

/// A mask in the page's voxels, `[z][y][x]`: 255 where the voxel at the centre is active, else 0.
/// @param mask  of any type that can be carved
/// @throws Failure naming the type of another grid
std::vector<std::uint8_t> page_mask(const openvdb::GridBase& mask, const PageGrid& page);

/// Values as bytes: `from` becomes 0, `to` becomes 255, evenly between and held beyond. `from` may
/// be above `to`.
std::vector<std::uint8_t> page_bytes(std::span<const float> values, float from, float to);

}  // namespace fluidcarve
