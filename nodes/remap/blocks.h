#pragma once

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <cstring>
#include <memory>
#include <vector>

namespace fluidcarve {

/// Whether two values are the same bit for bit.
template <class T>
bool same_bits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// The leaves and tiles of a tree that meet an index box, looked up once so that voxels are read without a search.
template <class TreeT>
class BlockWindow {
public:
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    struct Voxel {
        Value value;
        bool on;
    };

    explicit BlockWindow(const TreeT& tree) : accessor_(tree) {}

    void move_to(const openvdb::CoordBBox& box) {
        low_ = openvdb::Coord(box.min().x() >> 3, box.min().y() >> 3, box.min().z() >> 3);
        size_ = openvdb::Coord(box.max().x() >> 3, box.max().y() >> 3, box.max().z() >> 3) - low_ + openvdb::Coord(1);
        cells_.clear();
        openvdb::Coord at;
        for (at.x() = 0; at.x() < size_.x(); ++at.x())
            for (at.y() = 0; at.y() < size_.y(); ++at.y())
                for (at.z() = 0; at.z() < size_.z(); ++at.z()) {
                    const auto block = openvdb::Coord((low_.x() + at.x()) * 8, (low_.y() + at.y()) * 8, (low_.z() + at.z()) * 8);
                    Cell cell{accessor_.probeConstLeaf(block), {}};
                    if (!cell.leaf) cell.tile.on = accessor_.probeValue(block, cell.tile.value);
                    cells_.push_back(cell);
                }
    }
    /// Whether the window holds tiles only, all of one value and state: that of tile().
    bool uniform() const {
        for (const auto& cell : cells_)
            if (cell.leaf || cell.tile.on != tile().on || !same_bits(cell.tile.value, tile().value)) return false;
        return true;
    }
    const Voxel& tile() const { return cells_.front().tile; }
    /// @param at  inside the window
    Voxel get(const openvdb::Coord& at) const {
        const auto& cell =
            cells_[static_cast<std::size_t>((((at.x() >> 3) - low_.x()) * size_.y() + (at.y() >> 3) - low_.y()) * size_.z() + (at.z() >> 3) - low_.z())];
        if (!cell.leaf) return cell.tile;
        const auto offset = Leaf::coordToOffset(at);
        return {cell.leaf->getValue(offset), cell.leaf->isValueOn(offset)};
    }

private:
    struct Cell {
        const Leaf* leaf;
        Voxel tile;  ///< if there is no leaf
    };
    openvdb::tree::ValueAccessor<const TreeT> accessor_;
    openvdb::Coord low_, size_;
    std::vector<Cell> cells_;
};

/// Rewrites the 8^3 blocks of a grid that meet an index box, in parallel. Blocks that come out constant become tiles;
/// tiles that do not change stay whole.
/// @param make_worker  makes, once per thread or oftener, a `bool worker(const Coord& block, Leaf& out)`: fills all
///                     voxels of `out` from the untouched grid, or returns false where the block stays as it is
/// @return the grid itself if no voxel changes, else a copy
template <class GridT, class MakeWorker>
typename GridT::ConstPtr rewrite_blocks(const typename GridT::ConstPtr& grid, const openvdb::CoordBBox& box, MakeWorker&& make_worker) {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    struct Change {
        openvdb::Coord block;
        std::unique_ptr<Leaf> leaf;  ///< null: a tile
        Value value;
        bool on;
    };
    const openvdb::Coord low(box.min().x() >> 3, box.min().y() >> 3, box.min().z() >> 3);
    const auto size = openvdb::Coord(box.max().x() >> 3, box.max().y() >> 3, box.max().z() >> 3) - low + openvdb::Coord(1);
    std::vector<std::vector<Change>> rows(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()));

    const auto constant = [](const Leaf& leaf) {
        const bool on = leaf.isValueOn(0);
        if (on ? !leaf.getValueMask().isOn() : !leaf.getValueMask().isOff()) return false;
        const Value first = leaf.getValue(0);
        for (openvdb::Index n = 1; n < Leaf::SIZE; ++n)
            if (!same_bits(Value(leaf.getValue(n)), first)) return false;
        return true;
    };
    const auto same = [](const Leaf& a, const Leaf& b) {
        if (a.getValueMask() != b.getValueMask()) return false;
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n)
            if (!same_bits(Value(a.getValue(n)), Value(b.getValue(n)))) return false;
        return true;
    };

    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.size()), [&](const tbb::blocked_range<std::size_t>& range) {
        auto worker = make_worker();
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

    typename GridT::Ptr out;
    for (auto& row : rows)
        for (auto& change : row) {
            if (!out) out = grid->deepCopy();
            if (change.leaf) out->tree().addLeaf(change.leaf.release());
            else out->tree().addTile(1, change.block, change.value, change.on);
        }
    return out ? typename GridT::ConstPtr(out) : grid;
}

}  // namespace fluidcarve
