#include "nodes/remap/voxels/blocks.h"

#include "nodes/field/extent.h"
#include "nodes/grid_types.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <memory>

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
        if (!same_bits(typename Leaf::ValueType(a.getValue(n)), typename Leaf::ValueType(b.getValue(n)))) return false;
    return true;
}

}  // namespace

template <class GridT>
typename GridT::ConstPtr rewrite_blocks(const typename GridT::ConstPtr& grid, const openvdb::CoordBBox& box,
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
    const auto size = openvdb::Coord(box.max().x() >> 3, box.max().y() >> 3, box.max().z() >> 3) - low + openvdb::Coord(1);
    std::vector<std::vector<Change>> rows(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()));

    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.size()), [&](const tbb::blocked_range<std::size_t>& range) {
        const auto worker = make_worker();
        auto existing = grid->getConstAccessor();
        std::unique_ptr<Leaf> leaf;
        for (auto row = range.begin(); row < range.end(); ++row)
            for (int z = 0; z < size.z(); ++z) {
                const openvdb::Coord block((low.x() + static_cast<int>(row) / size.y()) * 8, (low.y() + static_cast<int>(row) % size.y()) * 8,
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
                if (old || on != change.on || !same_bits(value, change.value)) rows[row].push_back(std::move(change));
            }
    });

    // Copies by the base class: a copy by the grid's own type would compile the whole grid class here once more.
    const openvdb::GridBase& base = *grid;
    typename GridT::Ptr out;
    for (auto& row : rows)
        for (auto& change : row) {
            if (!out) out = openvdb::GridBase::grid<GridT>(base.deepCopyGrid());
            if (change.leaf) out->tree().addLeaf(change.leaf.release());
            else out->tree().addTile(1, change.block, change.value, change.on);
        }
    return out ? typename GridT::ConstPtr(out) : grid;
}

#define FLUIDCARVE_INSTANTIATE(GridT) \
    template GridT::ConstPtr rewrite_blocks<GridT>(const GridT::ConstPtr&, const openvdb::CoordBBox&, const std::function<BlockWorker<GridT>()>&);
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANTIATE)
#undef FLUIDCARVE_INSTANTIATE

}  // namespace fluidcarve
