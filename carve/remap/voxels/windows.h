#pragma once

#include "carve/base/values.h"
#include "carve/lattice/snap.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/trilinear.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

namespace fluidcarve {

/// The voxels of an index box, copied from leaves and tiles into arrays for fast repeated reads.
template <class TreeT>
class VoxelWindow {
public:
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;

    /// Copies the voxels of a box, extended along z to whole blocks.
    /// @param blocks  must hold them
    void move_to(const BlockWindow<TreeT>& blocks, const openvdb::CoordBBox& box) {
        low_ = openvdb::Coord(box.min().x(), box.min().y(), box.min().z() & ~7);
        size_ = openvdb::Coord(box.max().x(), box.max().y(), box.max().z() | 7) - low_ +
                openvdb::Coord(1);
        const auto count = static_cast<std::size_t>(size_.x()) *
                           static_cast<std::size_t>(size_.y()) *
                           static_cast<std::size_t>(size_.z());
        values_.resize(count);
        on_.resize(count / 8);
        std::size_t to = 0;
        for (int x = 0; x < size_.x(); ++x)
            for (int y = 0; y < size_.y(); ++y) {
                const auto first = low_.offsetBy(x, y, 0);
                const auto* from = &blocks.cell_of(first);
                for (int z = 0; z < size_.z(); z += 8, to += 8)
                    copy_row(*from++, Leaf::coordToOffset(first), to);
            }
    }
    void clear() { size_ = openvdb::Coord(0); }

    /// The cell of 2^3 voxels that holds a point.
    struct Cell {
        std::size_t lowest, nearest;  ///< indices of voxels in the window
        openvdb::Vec3d t;             ///< position from the lowest voxel to the highest, 0 to 1
    };
    /// Finds the cell of a point.
    /// @param q    index coordinates, snapped
    /// @param out  is set if the window holds the cell
    bool find(const openvdb::Vec3d& q, Cell& out) const {
        int lowest = 0, nearest = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double from = q[axis] - low_[axis];
            if (!(from >= 0 && from < size_[axis] - 1)) return false;
            const int below = static_cast<int>(from);
            const double t = q[axis] - (low_[axis] + below);
            out.t[axis] = t;
            lowest = lowest * size_[axis] + below;
            nearest = nearest * size_[axis] + below + (t >= 0.5 ? 1 : 0);
        }
        out.lowest = static_cast<std::size_t>(lowest);
        out.nearest = static_cast<std::size_t>(nearest);
        return true;
    }
    Value value(std::size_t place) const { return Value(values_[place]); }
    const auto& values() const { return values_; }
    /// Index of a voxel in the window. Its neighbour along index axis `axis` is step(axis) further
    /// on.
    std::ptrdiff_t place(const openvdb::Coord& at) const {
        const auto from = at - low_;
        return from.x() * step(0) + from.y() * step(1) + from.z();
    }
    std::ptrdiff_t step(int axis) const {
        return (axis == 0 ? std::ptrdiff_t{size_.y()} : 1) * (axis < 2 ? size_.z() : 1);
    }
    bool on(std::size_t place) const { return (on_[place / 8] >> place % 8 & 1) != 0; }

    /// Interpolates trilinearly in a cell.
    /// @param place  index of its lowest voxel
    /// @param t      position from there to the highest voxel, 0 to 1
    /// @param part   applied to each value
    template <class Part>
    auto between(std::size_t place, const openvdb::Vec3d& t, const Part& part) const {
        using Result = std::decay_t<decltype(part(std::declval<Value>()))>;
        using Weight = typename openvdb::VecTraits<Result>::ElementType;
        const auto* const values = values_.data() + place;
        // The sum below would lose the sign of -0, and pick up non-finite values of neighbours of
        // weight 0.
        if (t == openvdb::Vec3d(0)) return part(values[0]);
        const openvdb::math::Vec3<Weight> weight(t);
        const auto across = static_cast<std::size_t>(size_.z()),
                   along = across * static_cast<std::size_t>(size_.y());
        return trilinear([&](std::size_t n) { return Result(part(values[n])); }, {1, across, along},
                         std::array{weight.z(), weight.y(), weight.x()});
    }

    /// The cells that hold eight points.
    struct Cells {
        bool held;  ///< whether all lie in the window; if not, nothing else is set
        std::array<int, 8> lowest, nearest;  ///< indices of voxels in the window
        /// Position from the lowest voxel along x, y and z, 0 to 1.
        std::array<std::array<double, 8>, 3> from;
        openvdb::Vec3d t(std::size_t n) const { return {from[0][n], from[1][n], from[2][n]}; }
    };
    /// Finds the cells of eight points, in simple loops that compilers vectorize.
    /// @param points  index coordinates, `[axis][point]`
    void find(const std::array<std::array<double, 8>, 3>& points, Cells& out) const {
        out.lowest.fill(0);
        out.nearest.fill(0);
        int outside = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int first = low_[static_cast<int>(axis)], size = size_[static_cast<int>(axis)];
            for (std::size_t n = 0; n < 8; ++n) {
                const double q = snapped(points[axis][n]) - first;
                const int towards_0 = static_cast<int>(q),
                          below = towards_0 - (towards_0 > q ? 1 : 0);
                out.from[axis][n] = q - below;
                outside |= below | (size - 2 - below);
                out.lowest[n] = out.lowest[n] * size + below;
                out.nearest[n] = out.nearest[n] * size + below + (q - below >= 0.5 ? 1 : 0);
            }
        }
        out.held = outside >= 0;
    }

private:
    /// Copies eight voxels along z.
    /// @param offset  of the first one in its leaf
    void copy_row(const typename BlockWindow<TreeT>::Cell& from, openvdb::Index offset,
                  std::size_t to) {
        auto* const values = values_.data() + to;
        if (!from.leaf) {
            std::fill_n(values, 8, from.tile.value);
            on_[to / 8] = from.tile.on ? 0xff : 0;
            return;
        }
        if constexpr (has_values<Leaf>)
            std::memcpy(values, from.leaf->buffer().data() + offset, 8 * sizeof(Value));
        else
            for (openvdb::Index n = 0; n < 8; ++n) values[n] = from.leaf->getValue(offset + n);
        on_[to / 8] = from.leaf->getValueMask().template getWord<unsigned char>(offset / 8);
    }

    openvdb::Coord low_, size_{0};
    std::vector<std::conditional_t<std::is_same_v<Value, bool>, unsigned char, Value>> values_;
    std::vector<unsigned char> on_;  ///< a bit for each voxel
};

}  // namespace fluidcarve
