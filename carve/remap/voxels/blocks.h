#pragma once

#include "carve/field/leaf_cell.h"
#include "carve/remap/voxels/blend.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Distance of offsets between neighbours along an axis in a leaf of 8^3 voxels.
inline int offset_stride(int axis) { return 64 >> 3 * axis; }

/// Whether a leaf keeps an array of its values. Leaves of booleans and masks keep bits.
template <class Leaf>
inline constexpr bool has_values = !std::is_same_v<typename Leaf::ValueType, bool>;

/// The leaves and tiles of a tree that meet an index box. They are looked up once, so that voxels
/// are read without a search.
template <class TreeT>
class BlockWindow {
public:
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    using Voxel = ValueAndState<Value>;

    explicit BlockWindow(const TreeT& tree) : accessor_(tree) {}

    void move_to(const openvdb::CoordBBox& box) {
        low_ = openvdb::Coord(box.min().x() >> 3, box.min().y() >> 3, box.min().z() >> 3);
        size_ = openvdb::Coord(box.max().x() >> 3, box.max().y() >> 3, box.max().z() >> 3) - low_ +
                openvdb::Coord(1);
        cells_.clear();
        openvdb::Coord at;
        for (at.x() = 0; at.x() < size_.x(); ++at.x())
            for (at.y() = 0; at.y() < size_.y(); ++at.y())
                for (at.z() = 0; at.z() < size_.z(); ++at.z()) {
                    const auto block = openvdb::Coord(
                        (low_.x() + at.x()) * 8, (low_.y() + at.y()) * 8, (low_.z() + at.z()) * 8);
                    Cell cell{accessor_.probeConstLeaf(block), {}};
                    if (!cell.leaf) cell.tile.on = accessor_.probeValue(block, cell.tile.value);
                    cells_.push_back(cell);
                }
    }
    /// Whether the window holds only tiles with the value and state of tile().
    bool uniform() const {
        for (const auto& cell : cells_)
            if (cell.leaf || cell.tile.on != tile().on || !same_bits(cell.tile.value, tile().value))
                return false;
        return true;
    }
    const Voxel& tile() const { return cells_.front().tile; }
    /// @param at  inside the window
    Voxel get(const openvdb::Coord& at) const {
        const auto& cell = cell_of(at);
        if (!cell.leaf) return cell.tile;
        const auto offset = Leaf::coordToOffset(at);
        return {cell.leaf->getValue(offset), cell.leaf->isValueOn(offset)};
    }
    /// Reads eight voxels along z, all inside the window.
    /// @param first  its z is a multiple of 8
    void read(const openvdb::Coord& first, std::array<Voxel, 8>& out) const {
        const auto& cell = cell_of(first);
        if (!cell.leaf) return out.fill(cell.tile);
        const auto offset = Leaf::coordToOffset(first);
        if constexpr (has_values<Leaf>) {
            const auto* const values = cell.leaf->buffer().data() + offset;
            const auto states =
                cell.leaf->getValueMask().template getWord<unsigned char>(offset / 8);
            for (std::size_t z = 0; z < 8; ++z) out[z] = {values[z], (states >> z & 1) != 0};
        } else {
            for (openvdb::Index z = 0; z < 8; ++z)
                out[z] = {cell.leaf->getValue(offset + z), cell.leaf->isValueOn(offset + z)};
        }
    }
    /// Reads voxels in a line along an axis, all inside the window.
    /// @param direction  1: rising indices; -1: falling
    void read_row(openvdb::Coord at, int axis, int direction, std::span<Voxel> out) const {
        for (std::size_t n = 0; n < out.size();) {
            const auto& cell = cell_of(at);
            const int within = at[axis] & 7,
                      run = std::min(static_cast<int>(out.size() - n),
                                     direction > 0 ? 8 - within : within + 1);
            const auto part = out.subspan(n, static_cast<std::size_t>(run));
            if (cell.leaf)
                read_line(*cell.leaf, Leaf::coordToOffset(at),
                          static_cast<openvdb::Index>(direction * offset_stride(axis)), part);
            else std::ranges::fill(part, cell.tile);
            n += part.size();
            at[axis] += direction * run;
        }
    }
    /// Copies voxels in a line along an axis, all inside the window, to a line of a leaf along the
    /// same axis.
    /// @param direction  1: rising indices; -1: falling
    /// @param to         offset of the first voxel in the leaf
    void copy_line(openvdb::Coord at, int axis, int direction, int count, Leaf& out,
                   openvdb::Index to) const {
        const auto stride = static_cast<openvdb::Index>(direction * offset_stride(axis));
        while (count > 0) {
            const auto& cell = cell_of(at);
            const int within = at[axis] & 7,
                      run = std::min(count, direction > 0 ? 8 - within : within + 1);
            auto from = Leaf::coordToOffset(at);
            const auto copy = [&](const auto& value, const auto& set) {
                for (int n = 0; n < run; ++n, from += stride, to += stride) {
                    set(to, value(from));
                    out.setActiveState(to, cell.leaf ? cell.leaf->isValueOn(from) : cell.tile.on);
                }
            };
            if constexpr (has_values<Leaf>) {
                const auto* const values = cell.leaf ? cell.leaf->buffer().data() : nullptr;
                auto* const outs = out.buffer().data();
                copy([&](openvdb::Index n) { return values ? values[n] : cell.tile.value; },
                     [&](openvdb::Index n, const Value& value) { outs[n] = value; });
            } else {
                copy(
                    [&](openvdb::Index n) {
                        return cell.leaf ? Value(cell.leaf->getValue(n)) : cell.tile.value;
                    },
                    [&](openvdb::Index n, const Value& value) { out.setValueOnly(n, value); });
            }
            at[axis] += direction * run;
            count -= run;
        }
    }
    /// Reads all voxels at a leaf's place, which lies inside the window.
    void read(Leaf& out) const {
        const auto& cell = cell_of(out.origin());
        if (cell.leaf) out = *cell.leaf;
        else out.fill(cell.tile.value, cell.tile.on);
    }
    /// Sets eight voxels of a leaf.
    /// @param n  offset of the first one
    static void write(Leaf& out, openvdb::Index n, const std::array<Voxel, 8>& row) {
        if constexpr (has_values<Leaf>) {
            auto* const values = out.buffer().data() + n;
            unsigned states = 0;
            for (unsigned z = 0; z < 8; ++z) {
                values[z] = row[z].value;
                states |= static_cast<unsigned>(row[z].on) << z;
            }
            out.getValueMask().template getWord<unsigned char>(n / 8) =
                static_cast<unsigned char>(states);
        } else {
            for (openvdb::Index z = 0; z < 8; ++z) {
                out.setValueOnly(n + z, row[z].value);
                out.setActiveState(n + z, row[z].on);
            }
        }
    }
    bool holds(const openvdb::Coord& at) const {
        const auto from = openvdb::Coord(at.x() >> 3, at.y() >> 3, at.z() >> 3) - low_;
        const auto within = [](int n, int size) {
            return static_cast<unsigned>(n) < static_cast<unsigned>(size);
        };
        return within(from.x(), size_.x()) && within(from.y(), size_.y()) &&
               within(from.z(), size_.z());
    }
    /// A leaf or tile of the tree.
    struct Cell {
        const Leaf* leaf;
        Voxel tile;  ///< if there is no leaf
    };
    /// The leaf or tile that holds a voxel inside the window. The next ones along z follow it.
    const Cell& cell_of(const openvdb::Coord& at) const {
        return cells_[static_cast<std::size_t>(
            (((at.x() >> 3) - low_.x()) * size_.y() + (at.y() >> 3) - low_.y()) * size_.z() +
            (at.z() >> 3) - low_.z())];
    }

private:
    /// @param stride  of offsets from one voxel to the next
    static void read_line(const Leaf& leaf, openvdb::Index offset, openvdb::Index stride,
                          std::span<Voxel> out) {
        const auto read = [&](const auto& value) {
            for (auto& voxel : out) {
                voxel = {value(offset), leaf.isValueOn(offset)};
                offset += stride;
            }
        };
        if constexpr (has_values<Leaf>)
            read([values = leaf.buffer().data()](openvdb::Index n) -> const Value& {
                return values[n];
            });
        else read([&](openvdb::Index n) { return leaf.getValue(n); });
    }

    openvdb::tree::ValueAccessor<const TreeT> accessor_;
    openvdb::Coord low_, size_;
    std::vector<Cell> cells_;
};

template <class GridT>
using LeafOf = typename GridT::TreeType::LeafNodeType;

/// Fills all voxels of a block from the untouched grid. Returns false if the block stays as it is.
template <class GridT>
using BlockWorker = std::function<bool(const openvdb::Coord& block, LeafOf<GridT>& out)>;

/// A BlockWorker that calls an object of a class.
template <class GridT, class Worker, class... Args>
BlockWorker<GridT> block_worker(Args&&... args) {
    return [worker = std::make_shared<Worker>(std::forward<Args>(args)...)](
               const openvdb::Coord& block, LeafOf<GridT>& out) { return (*worker)(block, out); };
}

/// Rewrites the 8^3 blocks of a grid that meet an index box, in parallel. Constant blocks become
/// tiles; tiles that do not change stay whole. For the types of carve/volume/grid_types.h.
/// @param make_worker  called at least once per thread
/// @return the grid itself if no voxel changes, else a copy
template <class GridT>
typename GridT::ConstPtr rewrite_blocks(const typename GridT::ConstPtr& grid,
                                        const openvdb::CoordBBox& box,
                                        const std::function<BlockWorker<GridT>()>& make_worker);

}  // namespace fluidcarve
