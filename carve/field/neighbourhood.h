#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace fluidcarve {

/// The values of a leaf and of the voxels around it, read at once, so that stencils need no search.
/// It reads like an accessor, inside the leaf and up to one voxel beyond.
template <class Tree>
class Neighbourhood {
public:
    using ValueType = typename Tree::ValueType;

    /// @param origin  of the leaf
    template <class Accessor>
    void move_to(const Accessor& accessor, const openvdb::Coord& origin) {
        low_ = origin.offsetBy(-1, -1, -1);
        openvdb::Coord at;
        for (at.x() = 0; at.x() < 3; ++at.x())
            for (at.y() = 0; at.y() < 3; ++at.y())
                for (at.z() = 0; at.z() < 3; ++at.z())
                    read_block(accessor,
                               origin + openvdb::Coord(8 * (at.x() - 1), 8 * (at.y() - 1),
                                                       8 * (at.z() - 1)),
                               at);
    }

    const ValueType& getValue(const openvdb::Coord& at) const {
        return values_[place(at - low_, side)];
    }
    bool isValueOn(const openvdb::Coord& at) const {
        const auto off = at - low_;
        const auto& block =
            blocks_[place({block_of(off.x()), block_of(off.y()), block_of(off.z())}, 3)];
        return block.leaf ? block.leaf->isValueOn(at) : block.on;
    }
    bool probeValue(const openvdb::Coord& at, ValueType& value) const {
        value = getValue(at);
        return isValueOn(at);
    }

private:
    using Leaf = typename Tree::LeafNodeType;
    static constexpr std::size_t side = 10;
    static constexpr int last = 9;
    struct Block {
        const Leaf* leaf;
        bool on;  ///< if there is no leaf
    };

    /// Index in a cube of `size` entries a side.
    static std::size_t place(const openvdb::Coord& at, std::size_t size) {
        const std::array off{static_cast<std::size_t>(at.x()), static_cast<std::size_t>(at.y()),
                             static_cast<std::size_t>(at.z())};
        return (off[0] * size + off[1]) * size + off[2];
    }
    /// 0 before the leaf, 1 in it, 2 behind it.
    static int block_of(int off) { return off == 0 ? 0 : off == last ? 2 : 1; }

    /// @param at  the block's place: 0 to 2 along each axis
    template <class Accessor>
    void read_block(const Accessor& accessor, const openvdb::Coord& origin,
                    const openvdb::Coord& at) {
        const auto* const leaf = accessor.probeConstLeaf(origin);
        blocks_[place(at, 3)] = {leaf, !leaf && accessor.isValueOn(origin)};
        // Copies `count` voxels of the block, from its voxel `from` to `to` in values_.
        std::array<int, 3> from, to, count;
        for (int n = 0; n < 3; ++n) {
            const auto d = static_cast<std::size_t>(n);
            from[d] = at[n] == 0 ? 7 : 0;
            to[d] = at[n] == 0 ? 0 : at[n] == 1 ? 1 : last;
            count[d] = at[n] == 1 ? 8 : 1;
        }
        const auto tile = leaf ? ValueType() : accessor.getValue(origin);
        const auto* const values = leaf ? leaf->buffer().data() : nullptr;
        for (int x = 0; x < count[0]; ++x)
            for (int y = 0; y < count[1]; ++y) {
                auto* const out = values_.data() + place({to[0] + x, to[1] + y, to[2]}, side);
                if (values)
                    std::copy_n(values + 64 * (from[0] + x) + 8 * (from[1] + y) + from[2], count[2],
                                out);
                else std::fill_n(out, count[2], tile);
            }
    }

    openvdb::Coord low_;
    std::array<ValueType, side * side * side> values_;
    std::array<Block, 27> blocks_;
};

}  // namespace fluidcarve
