#pragma once

#include "carve/lattice/block_places.h"
#include "carve/lattice/snap.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/cubic.h"
#include "carve/remap/voxels/interpolation.h"
#include "carve/remap/voxels/windows.h"

#include <openvdb/tools/Interpolation.h>

#include <array>
#include <bit>
#include <cstddef>

namespace fluidcarve {

/// What is carved of each voxel: its whole value.
template <class Value>
struct WholeValue {
    using Part = Value;
    static constexpr std::size_t component = 0;  ///< the first one of the part
    /// From a voxel's centre to the position of the part, voxels.
    openvdb::Vec3d offset() const { return openvdb::Vec3d(0); }
    Part operator()(const Value& value) const { return value; }
};

/// What is carved of each voxel of a staggered grid: one component, at its own face.
template <class Value>
struct OneComponent {
    using Part = typename openvdb::VecTraits<Value>::ElementType;
    std::size_t component;
    /// Component c stands half a voxel below its voxel's centre along axis c.
    openvdb::Vec3d offset() const {
        openvdb::Vec3d out(0);
        out[static_cast<int>(component)] = -0.5;
        return out;
    }
    Part operator()(const Value& value) const { return value[static_cast<int>(component)]; }
};

/// Reads a grid between its voxels, fastest inside a box that is copied first. `Pick` is WholeValue
/// or OneComponent.
template <class GridT>
class VoxelReader {
    using TreeT = typename GridT::TreeType;
    using Value = typename TreeT::ValueType;

public:
    /// Eight voxels along z, or one component of them.
    template <class Part>
    using Row = std::array<ValueAndState<Part>, 8>;

    /// @param grid  must outlive it
    VoxelReader(const GridT& grid, Interpolation interpolation)
        : grid_(grid), values_(grid.getConstAccessor()), interpolation_(interpolation) {}

    /// Copies the voxels of a box, unless it is large. All other voxels are read one by one.
    /// @param blocks  must hold the box
    void move_to(const BlockWindow<TreeT>& blocks, const openvdb::CoordBBox& box) {
        if (box.volume() <= most_copied) window_.move_to(blocks, box);
        else window_.clear();
    }

    /// Reads at several positions.
    /// @param lanes  bit z is set if positions[z] is set and row[z] is read
    template <class Pick>
    void read(unsigned lanes, BlockPlaces::Positions& positions, const Pick& pick,
              Row<typename Pick::Part>& row) {
        if constexpr (can_blend<Value>)
            if (interpolation_ == Interpolation::linear && lanes != 0 &&
                read_copied(lanes, positions, pick, row))
                return;
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto z = static_cast<std::size_t>(std::countr_zero(lanes));
            row[z] = read(positions.at(z), pick);
        }
    }
    /// @param at  index coordinates
    template <class Pick>
    ValueAndState<typename Pick::Part> read(const openvdb::Vec3d& at, const Pick& pick) {
        const auto q = snapped(at);
        typename VoxelWindow<TreeT>::Cell cell;
        if (!window_.find(q, cell)) return read_searched(q, pick);
        if constexpr (can_blend<Value>) {
            if (interpolation_ == Interpolation::linear)
                return with_state(window_.between(cell.lowest, cell.t, pick), cell.nearest, pick);
            if (cell.t != openvdb::Vec3d(0))
                return with_state(pick(between(q, nearest_to(q))), cell.nearest, pick);
        }
        return {pick(window_.value(cell.nearest)), window_.on(cell.nearest)};
    }

private:
    /// Largest number of voxels that are copied for a block of 512.
    static constexpr std::size_t most_copied = 32 * 512;

    /// Reads linearly from the copied box. @return false if it does not hold all positions
    template <class Pick>
    bool read_copied(unsigned lanes, BlockPlaces::Positions& positions, const Pick& pick,
                     Row<typename Pick::Part>& row) {
        // Lanes that are not read need some valid position.
        for (auto idle = ~lanes & 0xff; idle != 0; idle &= idle - 1)
            positions.set(static_cast<std::size_t>(std::countr_zero(idle)),
                          positions.at(static_cast<std::size_t>(std::countr_zero(lanes))));
        window_.find(positions.xyz, cells_);
        if (!cells_.held) return false;
        for (std::size_t z = 0; z < 8; ++z) {
            if ((lanes >> z & 1) == 0) continue;
            const auto lowest = static_cast<std::size_t>(cells_.lowest[z]),
                       nearest = static_cast<std::size_t>(cells_.nearest[z]);
            row[z] = with_state(window_.between(lowest, cells_.t(z), pick), nearest, pick);
        }
        return true;
    }
    /// Reads outside the copied box.
    template <class Pick>
    ValueAndState<typename Pick::Part> read_searched(const openvdb::Vec3d& q, const Pick& pick) {
        const auto nearest = nearest_to(q);
        return with_state(
            pick(between(q, nearest)), values_.isValueOn(nearest),
            [&] { return pick(values_.getValue(nearest)); }, pick);
    }
    /// A value between the voxels of the window, and whether it is active.
    /// @param nearest  place of the nearest voxel
    template <class Part, class Pick>
    ValueAndState<Part> with_state(Part value, std::size_t nearest, const Pick& pick) const {
        return with_state(
            value, window_.on(nearest), [&] { return pick(window_.value(nearest)); }, pick);
    }
    /// @param on, of_nearest  state and value of the nearest voxel
    template <class Part, class Nearest, class Pick>
    ValueAndState<Part> with_state(Part value, bool on, const Nearest& of_nearest,
                                   const Pick& pick) const {
        if constexpr (can_blend<Part>)
            if (!openvdb::math::isFinite(value)) value = of_nearest();
        return {value, on || shows<Part>(value, of_nearest(), pick(grid_.background()))};
    }

    static openvdb::Coord nearest_to(const openvdb::Vec3d& q) {
        const auto low = voxel_below(q);
        const auto t = q - low.asVec3d();
        return {low.x() + (t.x() >= 0.5), low.y() + (t.y() >= 0.5), low.z() + (t.z() >= 0.5)};
    }
    /// The value between voxels, by a search for each of them.
    Value between(const openvdb::Vec3d& q, const openvdb::Coord& nearest) {
        if constexpr (can_blend<Value>) {
            if (q != nearest.asVec3d()) {
                switch (interpolation_) {
                    case Interpolation::linear:
                        return openvdb::tools::BoxSampler::sample(values_, q);
                    case Interpolation::quadratic:
                        return openvdb::tools::QuadraticSampler::sample(values_, q);
                    case Interpolation::cubic: return sample_cubic<Value>(values_, q);
                }
            }
        }
        return values_.getValue(nearest);
    }

    const GridT& grid_;
    typename GridT::ConstAccessor values_;
    const Interpolation interpolation_;
    VoxelWindow<TreeT> window_;
    typename VoxelWindow<TreeT>::Cells cells_;
};

}  // namespace fluidcarve
