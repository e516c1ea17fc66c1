#pragma once

#include "carve/field/dense.h"
#include "carve/field/extent.h"
#include "carve/field/neighbourhood.h"
#include "carve/volume/volume.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Checks that a grid's voxels are cubes in any orientation, as distances need.
/// @throws Failure naming the grid if they are not
void require_cubes(const openvdb::GridBase& grid);

/// Always throws.
/// @throws Failure naming the grid and its lowest active voxel whose value is not finite; `beside`
///   if there is none
[[noreturn]] void refuse_not_finite(const FloatGrid& grid, const openvdb::Coord& beside);
[[noreturn]] void refuse_not_finite(const VectorGrid& grid, const openvdb::Coord& beside);

/// Turns the border of each active tile into leaves, so that all voxels within `reach` voxels of
/// the remaining tile have its value.
/// @param reach  voxels
template <class Tree>
void open_tile_borders(Tree& tree, int reach = 1) {
    constexpr int step = Tree::LeafNodeType::DIM;
    const int border = (reach + step - 1) / step;  // in leaves
    std::vector<openvdb::CoordBBox> boxes;
    auto tile = tree.cbeginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) boxes.push_back(tile.getBoundingBox());
    for (const auto& box : boxes) {
        // Counted in leaves: one tile ends where index space ends.
        const int leaves = (box.max().x() - box.min().x() + 1) / step;
        const auto inside = [&](int n) { return n >= border && n < leaves - border; };
        for (int x = 0; x < leaves; ++x)
            for (int y = 0; y < leaves; ++y) {
                const bool inner = inside(x) && inside(y);
                for (int z = 0; z < leaves; ++z) {
                    if (inner && z == border) z = leaves - border;
                    tree.touchLeaf(box.min().offsetBy(x * step, y * step, z * step));
                }
            }
    }
}

/// Checks, before a stencil opens tiles, that the active voxels fit in memory and that their
/// neighbours lie within index space.
/// @param value_bytes, budget  as in require_dense_fits
/// @throws Failure as require_dense_fits and require_near
inline void require_stencil_fits(const openvdb::GridBase& grid, double value_bytes,
                                 std::uint64_t budget) {
    require_near(grid.getName(), grid.evalActiveVoxelBoundingBox());
    require_dense_fits(grid, value_bytes, budget);
}

namespace detail {

/// Leaves with more active voxels than this are read together with their neighbours.
constexpr openvdb::Index few_voxels = 64;

/// Sets the active values of `tree` to `op(reader of in, voxel)`; calls it once per tile.
/// @tparam beside  whether `op` reads neighbours
/// @param tree     with the active voxels of `in`
template <class Out, bool beside, class In, class Op>
typename Out::Ptr filled(const typename Out::TreeType::Ptr& tree, const In& in, const Op& op) {
    using Tree = typename Out::TreeType;
    using Leaf = typename Tree::LeafNodeType;
    std::mutex mutex;
    std::optional<openvdb::Coord> lowest;
    const auto value_at = [&](const auto& reader, const openvdb::Coord& at) {
        const auto out = op(reader, at);
        if (!openvdb::math::isFinite(out) || !openvdb::math::isFinite(reader.getValue(at))) {
            const std::lock_guard lock(mutex);
            if (!lowest || at < *lowest) lowest = at;
        }
        return out;
    };
    const auto fill = [&](Leaf& leaf, const auto& reader) {
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel)
            voxel.setValue(value_at(reader, voxel.getCoord()));
    };
    const openvdb::tree::LeafManager<Tree> leaves(*tree);
    tbb::parallel_for(leaves.leafRange(), [&](const auto& range) {
        const auto accessor = in.getConstUnsafeAccessor();
        Neighbourhood<typename In::TreeType> all;
        for (auto leaf = range.begin(); leaf; ++leaf) {
            if constexpr (beside) {
                if (leaf->onVoxelCount() > few_voxels) {
                    all.move_to(accessor, leaf->origin());
                    fill(*leaf, all);
                    continue;
                }
            } else if (const auto* const same = accessor.probeConstLeaf(leaf->origin())) {
                fill(*leaf, *same);
                continue;
            }
            fill(*leaf, accessor);
        }
    });
    const auto accessor = in.getConstUnsafeAccessor();
    auto tile = tree->beginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) tile.setValue(value_at(accessor, tile.getCoord()));
    if (lowest) refuse_not_finite(in, *lowest);

    auto out = Out::create(tree);
    out->setTransform(in.transform().copy());
    return out;
}
}  // namespace detail

/// A grid with the active voxels and transform of `in`: active values are `op(reader of in,
/// voxel)`, the background is `background`.
/// @param op  called from many threads with an accessor or a Neighbourhood; may read the 26
///   neighbours. Called once for the inside of an active tile, where all neighbourhoods are equal
/// @throws Failure as refuse_not_finite if an active value of `in` or a result is not finite
template <class Out, class In, class Op>
typename Out::Ptr map_stencil(const In& in, const typename Out::ValueType& background,
                              const Op& op) {
    using Tree = typename Out::TreeType;
    const auto tree = std::make_shared<Tree>(in.tree(), background, openvdb::TopologyCopy());
    open_tile_borders(*tree);
    return detail::filled<Out, true>(tree, in, op);
}

/// The same for an `op(value)` that needs only the voxel's own value. Tiles stay tiles.
template <class Out, class In, class Op>
typename Out::Ptr map_values(const In& in, const typename Out::ValueType& background,
                             const Op& op) {
    const auto tree =
        std::make_shared<typename Out::TreeType>(in.tree(), background, openvdb::TopologyCopy());
    return detail::filled<Out, false>(
        tree, in,
        [&op](const auto& reader, const openvdb::Coord& at) { return op(reader.getValue(at)); });
}

}  // namespace fluidcarve
