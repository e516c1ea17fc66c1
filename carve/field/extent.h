#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>

namespace fluidcarve {

/// Index coordinates from minus this to this: sizes of boxes, paddings and steps beyond them still
/// fit in 32 bits.
inline constexpr int farthest_voxel = 1'000'000'000;

/// Numbers of voxels of a box along x, y and z; 0 if it is empty. CoordBBox::dim() overflows from
/// 2^31 on.
std::array<std::int64_t, 3> extents_of(const openvdb::CoordBBox& box);
/// Number of voxels in a box, or the largest number if there are more.
std::uint64_t voxels_in(const openvdb::CoordBBox& box);
/// Box of the active voxels, by the leaves' masks. OpenVDB's evalActiveVoxelBoundingBox() gives the
/// same, but visits all voxels of a picture.
template <class GridT>
openvdb::CoordBBox active_box(const GridT& grid);
/// A box in words: "[0, 0, 0] to [7, 7, 7]: 8 x 8 x 8 voxels".
std::string span_text(const openvdb::CoordBBox& box);
/// A box that reaches some voxels further on all sides, at most to the ends of index space.
openvdb::CoordBBox padded(const openvdb::CoordBBox& box, int voxels);

/// The voxel nearest to a place; nothing if it is not finite or lies beyond `farthest_voxel`.
/// @param at  index coordinates
std::optional<openvdb::Coord> voxel_at(const openvdb::Vec3d& at);
/// A place to sample a grid at: clamped to `farthest_voxel`, and 0 where it is no number, since
/// samplers convert places to whole numbers.
/// @param at  index coordinates
openvdb::Vec3d near_place(const openvdb::Vec3d& at);
/// The voxels within a box in the world, and the next ones around it where a side lies between
/// voxels.
/// @param what  the box, as the message calls it: "the lattice"
/// @throws Failure naming the voxels, if they lie beyond `farthest_voxel`
openvdb::CoordBBox voxels_around(const openvdb::BBoxd& world,
                                 const openvdb::math::Transform& transform,
                                 const std::string& what);

/// Checks that a grid's voxels lie within `farthest_voxel`.
/// @param box     of the active voxels; may be empty
/// @param remedy  what to do beside cropping the grid: "crop the grid"
/// @throws Failure (input) naming grid, box and remedy
void require_near(const std::string& grid, const openvdb::CoordBBox& box,
                  const std::string& remedy = "crop the grid");
/// Checks a box whose blocks of 8^3 voxels are walked, in lines along an axis.
/// @param what  as the message calls it: "the lattice"
/// @throws Failure naming the box, if there are more than 2^27 lines or 2^35 blocks
void require_walkable(const std::string& what, const openvdb::CoordBBox& box, int axis);

template <class GridT>
openvdb::CoordBBox active_box(const GridT& grid) {
    openvdb::CoordBBox out;
    auto tile = grid.tree().cbeginValueOn();
    tile.setMaxDepth(GridT::TreeType::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) out.expand(tile.getBoundingBox());
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
        // A mask's word holds the voxels of one x, a byte of it those of one y.
        std::uint64_t words = 0, bytes = 0;
        int low = 8, high = -1;
        for (int x = 0; x < 8; ++x) {
            const auto word = leaf->getValueMask().template getWord<std::uint64_t>(
                static_cast<openvdb::Index>(x));
            if (word == 0) continue;
            low = std::min(low, x);
            high = x;
            words |= word;
        }
        if (words == 0) continue;
        for (int y = 0; y < 8; ++y) bytes |= words >> (8 * y) & 0xFF;
        out.expand(openvdb::CoordBBox(
            leaf->origin() +
                openvdb::Coord(low, std::countr_zero(words) / 8, std::countr_zero(bytes)),
            leaf->origin() + openvdb::Coord(high, (63 - std::countl_zero(words)) / 8,
                                            63 - std::countl_zero(bytes))));
    }
    return out;
}

}  // namespace fluidcarve
