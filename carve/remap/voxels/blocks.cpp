#include "carve/remap/voxels/blocks.h"

#include "carve/field/extent.h"
#include "carve/volume/grid_types.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

namespace fluidcarve {
namespace {

template <class Leaf>
bool constant(const Leaf& leaf) {
    const bool on = leaf.isValueOn(0);
    if (on ? !leaf.getValueMask().isOn() : !leaf.getValueMask().isOff()) return false;
    const typename Leaf::ValueType first = leaf.getValue(0);
    for (openvdb::Index n = 1; n < Leaf::SIZE; ++n)
        if (!same_bits(typename Leaf::ValueType(leaf.getValue(n)), first)) return false;
    return true;
}

template <class Leaf>
bool same(const Leaf& a, const Leaf& b) {
    if (a.getValueMask() != b.getValueMask()) return false;
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n)
        if (!same_bits(typename Leaf::ValueType(a.getValue(n)),
                       typename Leaf::ValueType(b.getValue(n))))
            return false;
    return true;
}

/// Copies the tiles of a node and of its descendants, except background tiles.
/// @param to  without leaves
template <class Node, class TreeT>
void copy_tiles(const Node& node, TreeT& to) {
    const auto* const table = node.getTable();
    for (openvdb::Index n = 0; n < Node::NUM_VALUES; ++n) {
        if (node.isChildMaskOn(n)) {
            if constexpr (Node::LEVEL > 1) copy_tiles(*table[n].getChild(), to);
        } else if (node.isValueMaskOn(n) || !same_bits(table[n].getValue(), to.background())) {
            to.addTile(Node::LEVEL, node.offsetToGlobalCoord(n), table[n].getValue(),
                       node.isValueMaskOn(n));
        }
    }
}

}  // namespace

template <class GridT>
typename GridT::ConstPtr rewrite_blocks(const typename GridT::ConstPtr& grid,
                                        const openvdb::CoordBBox& box,
                                        const std::function<BlockWorker<GridT>()>& make_worker) {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    struct Change {
        openvdb::Coord block;
        std::unique_ptr<Leaf> leaf;  ///< null: a tile
        Value value;
        bool on;
    };
    require_walkable(fmt::format("the lattice, in voxels of grid '{}',", grid->getName()), box, 2);
    const openvdb::Coord low(box.min().x() >> 3, box.min().y() >> 3, box.min().z() >> 3);
    const auto size = openvdb::Coord(box.max().x() >> 3, box.max().y() >> 3, box.max().z() >> 3) -
                      low + openvdb::Coord(1);
    std::vector<std::vector<Change>> rows(static_cast<std::size_t>(size.x()) *
                                          static_cast<std::size_t>(size.y()));

    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.size()), [&](const tbb::blocked_range<
                                                                           std::size_t>& range) {
        const auto worker = make_worker();
        auto existing = grid->getConstAccessor();
        std::unique_ptr<Leaf> leaf;
        for (auto row = range.begin(); row < range.end(); ++row)
            for (int z = 0; z < size.z(); ++z) {
                const openvdb::Coord block((low.x() + static_cast<int>(row) / size.y()) * 8,
                                           (low.y() + static_cast<int>(row) % size.y()) * 8,
                                           (low.z() + z) * 8);
                if (!leaf) leaf = std::make_unique<Leaf>(block, grid->background(), false);
                leaf->setOrigin(block);
                if (!worker(block, *leaf)) continue;
                const auto* const old = existing.probeConstLeaf(block);
                if (old && same(*old, *leaf)) continue;
                if (!constant(*leaf)) {
                    rows[row].push_back({block, std::unique_ptr<Leaf>(leaf.release()), {}, false});
                    continue;
                }
                Change change{block, nullptr, leaf->getValue(0), leaf->isValueOn(0)};
                Value value;
                const bool on = existing.probeValue(block, value);
                if (old || on != change.on || !same_bits(value, change.value))
                    rows[row].push_back(std::move(change));
            }
    });

    if (std::ranges::all_of(rows, [](const auto& row) { return row.empty(); })) return grid;
    const auto changes = [&](const openvdb::Coord& block) {
        const auto at = openvdb::Coord(block.x() >> 3, block.y() >> 3, block.z() >> 3) - low;
        if (at.x() < 0 || at.x() >= size.x() || at.y() < 0 || at.y() >= size.y()) return false;
        const auto& row =
            rows[static_cast<std::size_t>(at.x()) * static_cast<std::size_t>(size.y()) +
                 static_cast<std::size_t>(at.y())];
        const auto found = std::ranges::lower_bound(
            row, block.z(), {}, [](const Change& change) { return change.block.z(); });
        return found != row.end() && found->block == block;
    };
    std::vector<const Leaf*> kept;
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf)
        if (!changes(leaf->origin())) kept.push_back(&*leaf);
    std::vector<std::unique_ptr<Leaf>> copies(kept.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, kept.size(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (auto n = range.begin(); n < range.end(); ++n)
                              copies[n] = std::make_unique<Leaf>(*kept[n]);
                      });

    // Made by the base class: the grid's own type would compile the whole grid class here once
    // more.
    const openvdb::GridBase& base = *grid;
    const auto out = openvdb::GridBase::grid<GridT>(base.copyGridWithNewTree());
    auto& tree = out->tree();
    const auto& root = grid->tree().root();
    for (auto tile = root.cbeginValueAll(); tile; ++tile)
        tree.addTile(TreeT::RootNodeType::LEVEL, tile.getCoord(), tile.getValue(),
                     tile.isValueOn());
    for (auto child = root.cbeginChildOn(); child; ++child) copy_tiles(*child, tree);
    openvdb::tree::ValueAccessor<TreeT> to(tree);
    for (auto& leaf : copies) to.addLeaf(leaf.release());
    for (auto& row : rows)
        for (auto& change : row) {
            Value there;
            if (change.leaf) to.addLeaf(change.leaf.release());
            else if (to.probeValue(change.block, there) != change.on ||
                     !same_bits(there, change.value))
                to.addTile(1, change.block, change.value, change.on);
        }
    return out;
}

#define FLUIDCARVE_INSTANTIATE(GridT)                                         \
    template GridT::ConstPtr rewrite_blocks<GridT>(const GridT::ConstPtr&,    \
                                                   const openvdb::CoordBBox&, \
                                                   const std::function<BlockWorker<GridT>()>&);
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANTIATE)
#undef FLUIDCARVE_INSTANTIATE

}  // namespace fluidcarve
