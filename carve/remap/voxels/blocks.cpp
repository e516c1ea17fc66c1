#include "carve/remap/voxels/blocks.h"

#include "carve/base/each_in_parallel.h"
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

/// The blocks of a box that become others.
template <class GridT>
class BlockChanges {
public:
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;

    BlockChanges(const GridT& grid, const openvdb::CoordBBox& box)
        : grid_(grid),
          low_(box.min().x() >> 3, box.min().y() >> 3, box.min().z() >> 3),
          size_(openvdb::Coord(box.max().x() >> 3, box.max().y() >> 3, box.max().z() >> 3) - low_ +
                openvdb::Coord(1)),
          rows_(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y())) {}

    void find(const std::function<BlockWorker<GridT>()>& make_worker) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows_.size()),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              Work work{make_worker(), grid_.getConstAccessor(), nullptr};
                              for (auto row = range.begin(); row < range.end(); ++row)
                                  for (int z = 0; z < size_.z(); ++z) visit(row, z, work);
                          });
    }
    bool empty() const {
        return std::ranges::all_of(rows_, [](const auto& row) { return row.empty(); });
    }
    bool holds(const openvdb::Coord& block) const {
        const auto at = openvdb::Coord(block.x() >> 3, block.y() >> 3, block.z() >> 3) - low_;
        if (at.x() < 0 || at.x() >= size_.x() || at.y() < 0 || at.y() >= size_.y()) return false;
        const auto& row =
            rows_[static_cast<std::size_t>(at.x()) * static_cast<std::size_t>(size_.y()) +
                  static_cast<std::size_t>(at.y())];
        const auto found = std::ranges::lower_bound(
            row, block.z(), {}, [](const Change& change) { return change.block.z(); });
        return found != row.end() && found->block == block;
    }
    /// Moves the blocks to a tree.
    void give(openvdb::tree::ValueAccessor<TreeT>& to) {
        for (auto& row : rows_)
            for (auto& change : row) {
                Value there;
                if (change.leaf) to.addLeaf(change.leaf.release());
                else if (to.probeValue(change.block, there) != change.on ||
                         !same_bits(there, change.value))
                    to.addTile(1, change.block, change.value, change.on);
            }
    }

private:
    struct Change {
        openvdb::Coord block;
        std::unique_ptr<Leaf> leaf;  ///< null: a tile
        Value value;
        bool on;
    };
    /// What a thread works with.
    struct Work {
        BlockWorker<GridT> worker;
        typename GridT::ConstAccessor existing;
        std::unique_ptr<Leaf> leaf;  ///< to fill; null: a new one is needed
    };

    void visit(std::size_t row, int z, Work& work) {
        const openvdb::Coord block((low_.x() + static_cast<int>(row) / size_.y()) * 8,
                                   (low_.y() + static_cast<int>(row) % size_.y()) * 8,
                                   (low_.z() + z) * 8);
        auto& leaf = work.leaf;
        if (!leaf) leaf = std::make_unique<Leaf>(block, grid_.background(), false);
        leaf->setOrigin(block);
        if (!work.worker(block, *leaf)) return;
        const auto* const old = work.existing.probeConstLeaf(block);
        if (old && same(*old, *leaf)) return;
        if (!constant(*leaf)) {
            rows_[row].push_back({block, std::move(leaf), {}, false});
            return;
        }
        Change change{block, nullptr, leaf->getValue(0), leaf->isValueOn(0)};
        Value value;
        const bool on = work.existing.probeValue(block, value);
        if (old || on != change.on || !same_bits(value, change.value))
            rows_[row].push_back(std::move(change));
    }

    const GridT& grid_;
    const openvdb::Coord low_, size_;        ///< of the box, blocks
    std::vector<std::vector<Change>> rows_;  ///< `[x][y]`, along z
};

/// Copies of the leaves that do not change.
template <class GridT>
auto kept_leaves(const GridT& grid, const BlockChanges<GridT>& changes) {
    using Leaf = typename GridT::TreeType::LeafNodeType;
    std::vector<const Leaf*> kept;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
        if (!changes.holds(leaf->origin())) kept.push_back(&*leaf);
    std::vector<std::unique_ptr<Leaf>> copies(kept.size());
    each_in_parallel(kept.size(), 64,
                     [&](std::size_t n) { copies[n] = std::make_unique<Leaf>(*kept[n]); });
    return copies;
}

}  // namespace

template <class GridT>
typename GridT::ConstPtr rewrite_blocks(const typename GridT::ConstPtr& grid,
                                        const openvdb::CoordBBox& box,
                                        const std::function<BlockWorker<GridT>()>& make_worker) {
    using TreeT = typename GridT::TreeType;
    require_walkable(fmt::format("the lattice, in voxels of grid '{}',", grid->getName()), box, 2);
    BlockChanges<GridT> changes(*grid, box);
    changes.find(make_worker);
    if (changes.empty()) return grid;
    auto kept = kept_leaves(*grid, changes);

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
    for (auto& leaf : kept) to.addLeaf(leaf.release());
    changes.give(to);
    return out;
}

#define FLUIDCARVE_INSTANTIATE(GridT)                                         \
    template GridT::ConstPtr rewrite_blocks<GridT>(const GridT::ConstPtr&,    \
                                                   const openvdb::CoordBBox&, \
                                                   const std::function<BlockWorker<GridT>()>&);
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANTIATE)
#undef FLUIDCARVE_INSTANTIATE

}  // namespace fluidcarve
