#pragma once

#include "nodes/payloads.h"

#include <openvdb/tree/LeafManager.h>

#include <mutex>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Edge length of a grid's cubic voxels, world units.
/// @throws Failure naming the grid if its voxels are not cubes along the world's axes
double cubic_voxel_size(const openvdb::GridBase& grid);

/// Always throws. @throws Failure naming the grid and its lowest active voxel with a value that is not finite, else `beside`
[[noreturn]] void refuse_not_finite(const FloatGrid& grid, const openvdb::Coord& beside);
[[noreturn]] void refuse_not_finite(const VectorGrid& grid, const openvdb::Coord& beside);

/// Turns the border of each active tile into leaves, so that all voxels within `reach` voxels of what remains of the tile have its value.
/// @param reach  voxels
template <class Tree>
void open_tile_borders(Tree& tree, int reach = 1) {
    constexpr int step = Tree::LeafNodeType::DIM;
    const int border = (reach + step - 1) / step * step;
    std::vector<openvdb::CoordBBox> boxes;
    auto tile = std::as_const(tree).cbeginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) boxes.push_back(tile.getBoundingBox());
    for (const auto& box : boxes) {
        const auto last = box.max().offsetBy(1 - step);
        for (int x = box.min().x(); x <= last.x(); x += step)
            for (int y = box.min().y(); y <= last.y(); y += step) {
                const bool inner = x >= box.min().x() + border && x <= last.x() - border && y >= box.min().y() + border && y <= last.y() - border;
                for (int z = box.min().z(); z <= last.z(); z += step) {
                    if (inner && z == box.min().z() + border) z = last.z() - border + step;
                    tree.touchLeaf({x, y, z});
                }
            }
    }
}

namespace detail {
/// Sets the active values of `tree` to `op(accessor of in, voxel)`; calls it once per tile.
/// @param tree  with the active voxels of `in`
template <class Out, class In, class Op>
typename Out::Ptr filled(const typename Out::TreeType::Ptr& tree, const In& in, const Op& op) {
    using Tree = typename Out::TreeType;
    std::mutex mutex;
    std::optional<openvdb::Coord> lowest;
    const auto value_at = [&](auto& accessor, const openvdb::Coord& at) {
        const auto out = op(accessor, at);
        if (!openvdb::math::isFinite(out) || !openvdb::math::isFinite(accessor.getValue(at))) {
            const std::lock_guard lock(mutex);
            if (!lowest || at < *lowest) lowest = at;
        }
        return out;
    };
    openvdb::tree::LeafManager<Tree>(*tree).foreach ([&](typename Tree::LeafNodeType& leaf, std::size_t) {
        auto accessor = in.getConstUnsafeAccessor();
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) voxel.setValue(value_at(accessor, voxel.getCoord()));
    });
    auto accessor = in.getConstUnsafeAccessor();
    auto tile = tree->beginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) tile.setValue(value_at(accessor, tile.getCoord()));
    if (lowest) refuse_not_finite(in, *lowest);

    auto out = Out::create(tree);
    out->setTransform(in.transform().copy());
    return out;
}
}  // namespace detail

/// A grid with the active voxels and transform of `in`: active values are `op(accessor of in, voxel)`, the background is `background`.
/// @param op  called from many threads; may read the 26 neighbours. Called once for the inside of an active tile, where all
///            neighbourhoods are equal
/// @throws Failure as refuse_not_finite if an active value of `in` or a result is not finite
template <class Out, class In, class Op>
typename Out::Ptr map_stencil(const In& in, const typename Out::ValueType& background, const Op& op) {
    using Tree = typename Out::TreeType;
    const auto tree = std::make_shared<Tree>(in.tree(), background, openvdb::TopologyCopy());
    open_tile_borders(*tree);
    return detail::filled<Out>(tree, in, op);
}

/// The same for an `op(value)` that needs only the voxel's own value. Tiles stay tiles.
template <class Out, class In, class Op>
typename Out::Ptr map_values(const In& in, const typename Out::ValueType& background, const Op& op) {
    const auto tree = std::make_shared<typename Out::TreeType>(in.tree(), background, openvdb::TopologyCopy());
    return detail::filled<Out>(tree, in, [&op](auto& accessor, const openvdb::Coord& at) { return op(accessor.getValue(at)); });
}

}  // namespace fluidcarve
