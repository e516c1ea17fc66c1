#pragma once

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/trilinear.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fluidcarve {

/// The low-frequency part of a grid: its values, smoothed, in coarse cells around its active
/// voxels. Inactive voxels, and places beyond the cells, count as background.
class SlowPart {
public:
    /// @param grid   of floats, doubles or vectors of them
    /// @param sigma  about the standard deviation of the smoothing, voxels
    template <class GridT>
    SlowPart(const GridT& grid, double sigma) {
        const auto box = grid.evalActiveVoxelBoundingBox();
        for (std::size_t c = 0; c < components<GridT>; ++c)
            background_[c] = component(grid.background(), c);
        if (box.empty()) return;
        require_near(grid.getName(), box);
        // A leaf holds whole cells, so that no two leaves write the same one. Smoothing adds to
        // their width.
        while ((1 << shift_) * 1.5 * deviation_of_cell < sigma && shift_ < 3) ++shift_;
        scale_ = 1.0 / (1 << shift_);
        count_ = components<GridT>;
        low_ = box.min() - openvdb::Coord(2 << shift_);
        double all = static_cast<double>(count_);
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] = low_[axis] & ~7;
            size_[axis] =
                static_cast<int>(((std::int64_t{box.max()[axis]} - low_[axis]) >> shift_) + 3);
            all *= size_[axis];
        }
        if (all > most_values)
            throw Failure(fmt::format("grid '{}' is too wide for `join: fade`, {}: crop the grid, "
                                      "or state `join: squeeze`",
                                      grid.getName(), span_text(box)),
                          Failure::Kind::input);
        values_.resize(static_cast<std::size_t>(all));
        add_values(grid);
        const auto passes = std::lround(
            std::clamp(std::pow(sigma / (deviation_of_cell * (1 << shift_)), 2), 1.0, most_passes));
        for (int pass = 0; pass < passes; ++pass)
            for (int axis = 0; axis < 3; ++axis) smooth(axis);
    }

    /// One component of the slow part.
    /// @param at  index coordinates
    double at(const openvdb::Vec3d& at, std::size_t component) const {
        std::array<float, 3> part{};
        std::size_t low = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double x = (at[axis] - low_[axis] + 0.5) * scale_ - 0.5;
            if (!(x >= 0 && x < size_[axis] - 1)) return background_[component];
            const auto cell = static_cast<std::size_t>(x);
            low = low * static_cast<std::size_t>(size_[axis]) + cell;
            part[static_cast<std::size_t>(axis)] =
                static_cast<float>(x - static_cast<double>(cell));
        }
        const auto along_z = count_, along_y = count_ * static_cast<std::size_t>(size_.z()),
                   along_x = along_y * static_cast<std::size_t>(size_.y());
        const float* const from = values_.data() + low * count_ + component;
        return background_[component] + trilinear([from](std::size_t n) { return from[n]; },
                                                  {along_z, along_y, along_x},
                                                  std::array{part[2], part[1], part[0]});
    }

private:
    template <class GridT>
    static constexpr std::size_t components =
        openvdb::VecTraits<typename GridT::ValueType>::IsVec ? 3 : 1;
    /// Standard deviation of cells of one voxel that are averaged by a tent once and interpolated,
    /// voxels.
    static constexpr double deviation_of_cell = 0.87;
    static constexpr double most_values = 0x1p30;
    static constexpr double most_passes = 4096;

    template <class Value>
    static float component(const Value& value, std::size_t c) {
        if constexpr (openvdb::VecTraits<Value>::IsVec)
            return static_cast<float>(value[static_cast<int>(c)]);
        else return static_cast<void>(c), static_cast<float>(value);
    }

    std::size_t place(const std::array<std::size_t, 3>& cell) const {
        return ((cell[0] * static_cast<std::size_t>(size_.y()) + cell[1]) *
                    static_cast<std::size_t>(size_.z()) +
                cell[2]) *
               count_;
    }

    template <class GridT>
    void add_values(const GridT& grid) {
        using TreeT = typename GridT::TreeType;
        const float share = 1 / static_cast<float>(1 << 3 * shift_);
        const auto add = [&](const openvdb::Coord& at, const auto& value) {
            const auto to = place({static_cast<std::size_t>((at.x() - low_.x()) >> shift_),
                                   static_cast<std::size_t>((at.y() - low_.y()) >> shift_),
                                   static_cast<std::size_t>((at.z() - low_.z()) >> shift_)});
            for (std::size_t c = 0; c < count_; ++c)
                values_[to + c] += share * (component(value, c) - background_[c]);
        };
        openvdb::tree::LeafManager<const TreeT>(grid.tree())
            .foreach ([&](const auto& leaf, std::size_t) {
                for (auto on = leaf.cbeginValueOn(); on; ++on) add(on.getCoord(), *on);
            });
        auto tile = grid.tree().cbeginValueOn();
        tile.setMaxDepth(static_cast<openvdb::Index>(TreeT::DEPTH) - 2);
        for (; tile; ++tile) {
            const auto box = tile.getBoundingBox();
            for (auto at = box.begin(); at; ++at) add(*at, *tile);
        }
    }

    /// Averages each cell with its neighbours along an axis, by the weights 1, 2 and 1.
    void smooth(int axis) {
        const std::array<int, 2> across{axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
        tbb::parallel_for(
            tbb::blocked_range<int>(0, size_[across[0]]),
            [&](const tbb::blocked_range<int>& range) {
                std::vector<float> line(static_cast<std::size_t>(size_[axis]) + 2);
                for (int i = range.begin(); i < range.end(); ++i)
                    for (int j = 0; j < size_[across[1]]; ++j)
                        for (std::size_t c = 0; c < count_; ++c) {
                            std::array<std::size_t, 3> cell{};
                            cell[static_cast<std::size_t>(across[0])] = static_cast<std::size_t>(i);
                            cell[static_cast<std::size_t>(across[1])] = static_cast<std::size_t>(j);
                            auto& along = cell[static_cast<std::size_t>(axis)];
                            const auto count = static_cast<std::size_t>(size_[axis]);
                            for (along = 0; along < count; ++along)
                                line[along + 1] = values_[place(cell) + c];
                            for (along = 0; along < count; ++along)
                                values_[place(cell) + c] = 0.25f * line[along] +
                                                           0.5f * line[along + 1] +
                                                           0.25f * line[along + 2];
                        }
            });
    }

    double scale_ = 1;  ///< cells per voxel
    int shift_ = 0;     ///< cells have 2^shift voxels along each axis
    openvdb::Coord low_{0}, size_{0};
    std::size_t count_ = 1;  ///< components
    std::array<float, 3> background_{};
    std::vector<float> values_;  ///< `[x][y][z][component]`, minus the background
};

}  // namespace fluidcarve
