#include "nodes/preview/difference.h"

#include "nodes/preview/lines_of_sight.h"

#include <algorithm>
#include <array>

namespace fluidcarve {

namespace {

/// The values of a grid in the block of one leaf, where the grid may have a leaf or a tile.
template <class Grid>
class Block {
public:
    Block(const Grid& grid, const openvdb::Coord& origin)
        : leaf_(grid.tree().probeConstLeaf(origin)) {
        if (!leaf_) tile_ = seen_value(grid.tree().getValue(origin));
    }
    float at(openvdb::Index offset) const {
        return leaf_ ? seen_value(leaf_->getValue(offset)) : tile_;
    }

private:
    const typename Grid::TreeType::LeafNodeType* leaf_;
    float tile_ = 0;
};

/// Edge of the aligned cube around a place that the tree stores as one value.
template <class Grid>
int alike(const typename Grid::ConstAccessor& values, const openvdb::Coord& at) {
    constexpr std::array sides{4096, 128, 8,
                               1};  // of a root's tile, and of the tiles and voxels below
    return sides[static_cast<std::size_t>(std::max(values.getValueDepth(at), 0))];
}

template <class Grid>
class Comparison {
public:
    Comparison(const Grid& before, const Grid& after, View view, const openvdb::CoordBBox& box,
               int most)
        : before_(before),
          after_(after),
          view_(view),
          box_(box),
          out_(blank_projection(box, view, most, Projection::Keep::largest)) {}

    Projection projection() {
        MaskGrid::TreeType compared(before_.tree(), false, true, openvdb::TopologyCopy());
        compared.topologyUnion(after_.tree());
        for_each_leaf_in_sight(compared, view_, box_, out_.cell,
                               [&](const auto& leaf) { compare_leaf(leaf); });
        auto tile = compared.cbeginValueOn();
        tile.setMaxDepth(tile.getLeafDepth() - 1);
        for (; tile; ++tile) compare_cube(tile.getBoundingBox());
        return std::move(out_);
    }

private:
    void compare_leaf(const MaskGrid::TreeType::LeafNodeType& leaf) {
        const Block old(before_, leaf.origin());
        const Block now(after_, leaf.origin());
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel)
            if (const auto at = voxel.getCoord(); box_.isInside(at))
                out_.see(at, view_, now.at(voxel.pos()) - old.at(voxel.pos()));
    }

    /// Compares a cube of active voxels, in parts where a tree has parts.
    void compare_cube(const openvdb::CoordBBox& cube) {
        auto seen = cube;
        seen.intersect(box_);
        if (seen.empty()) return;
        const int side = cube.dim().x(), same = std::min({side, alike<Grid>(old_, cube.min()),
                                                          alike<Grid>(now_, cube.min())});
        if (same == side) {
            const float value =
                seen_value(now_.getValue(cube.min())) - seen_value(old_.getValue(cube.min()));
            const auto covered = in_cells(face_of(seen, view_), out_.cell);
            for (int y = covered.first[1]; y <= covered.last[1]; ++y)
                for (int x = covered.first[0]; x <= covered.last[0]; ++x) out_.see(x, y, value);
            return;
        }
        if (side == MaskGrid::TreeType::LeafNodeType::DIM)
            return compare_leaf(MaskGrid::TreeType::LeafNodeType(cube.min(), true, true));
        const int part = side == 4096 ? 128 : 8;
        for (int x = 0; x < side; x += part)
            for (int y = 0; y < side; y += part)
                for (int z = 0; z < side; z += part)
                    compare_cube(
                        openvdb::CoordBBox::createCube(cube.min().offsetBy(x, y, z), part));
    }

    const Grid &before_, &after_;
    View view_;
    openvdb::CoordBBox box_;
    typename Grid::ConstAccessor old_ = before_.getConstAccessor(),
                                 now_ = after_.getConstAccessor();
    Projection out_;
};

}  // namespace

Projection largest_difference(const FloatGrid& before, const FloatGrid& after, View view,
                              const openvdb::CoordBBox& box, int most) {
    return Comparison(before, after, view, box, most).projection();
}

Projection largest_difference(const VectorGrid& before, const VectorGrid& after, View view,
                              const openvdb::CoordBBox& box, int most) {
    return Comparison(before, after, view, box, most).projection();
}

}  // namespace fluidcarve
