#include "nodes/preview/difference.h"

#include "nodes/field/dense.h"
#include "nodes/preview/lines_of_sight.h"

#include <cmath>

namespace fluidcarve {

namespace {

/// The values of a grid in the block of one leaf, where the grid may have a leaf or a tile.
template <class Grid>
class Block {
public:
    Block(const Grid& grid, const openvdb::Coord& origin) : leaf_(grid.tree().probeConstLeaf(origin)) {
        if (!leaf_) tile_ = seen_value(grid.tree().getValue(origin));
    }
    float at(openvdb::Index offset) const { return leaf_ ? seen_value(leaf_->getValue(offset)) : tile_; }

private:
    const typename Grid::TreeType::LeafNodeType* leaf_;
    float tile_ = 0;
};

template <class Grid>
Projection difference(const Grid& before, const Grid& after, View view, const openvdb::CoordBBox& box, std::uint64_t budget, int most) {
    const auto either = MaskGrid::create(std::make_shared<MaskGrid::TreeType>(before.tree(), false, true, openvdb::TopologyCopy()));
    either->setName(before.getName());
    auto& compared = either->tree();
    compared.topologyUnion(after.tree());
    compared.clip(box);
    require_dense_fits(*either, state_bytes, budget);
    compared.voxelizeActiveTiles();

    auto out = blank_projection(box, view, most, Projection::Keep::largest);
    for_each_leaf_in_sight(compared, view, box, out.cell, [&](const auto& leaf) {
        const Block old(before, leaf.origin());
        const Block now(after, leaf.origin());
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) out.see(voxel.getCoord(), view, now.at(voxel.pos()) - old.at(voxel.pos()));
    });
    return out;
}

}  // namespace

Projection largest_difference(const FloatGrid& before, const FloatGrid& after, View view, const openvdb::CoordBBox& box, std::uint64_t budget, int most) {
    return difference(before, after, view, box, budget, most);
}

Projection largest_difference(const VectorGrid& before, const VectorGrid& after, View view, const openvdb::CoordBBox& box, std::uint64_t budget, int most) {
    return difference(before, after, view, box, budget, most);
}

}  // namespace fluidcarve
