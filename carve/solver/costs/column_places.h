#pragma once

#include "carve/lattice/lattice.h"
#include "carve/lattice/mapping.h"
#include "carve/seam/window.h"

#include <openvdb/math/Coord.h>
#include <openvdb/math/Transform.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fluidcarve {

/// Finds the vertices of a column in a grid's index space. They stand on a line at equal distances,
/// unless the column runs along a bent path or the grid's transform is not linear.
class ColumnPlaces {
public:
    ColumnPlaces(const openvdb::math::Transform& transform, const Lattice& lattice, Axis axis)
        : transform_(transform),
          linear_(transform_.isLinear()),
          bent_(axis == Axis::w && !lattice.is_box()),
          lattice_(lattice),
          axis_(axis) {}

    /// Moves to a column.
    /// @param first  the column's first vertex (i, j, k)
    void move_to(const std::array<int, 3>& first) {
        const openvdb::Vec3d at(first[0], first[1], first[2]);
        vertex_ = at;
        if (bent_) return;
        auto next = at;
        next[static_cast<int>(axis_)] += 1;
        const auto position = [&](const openvdb::Vec3d& vertex) {
            const auto world = lattice_.position(vertex);
            return linear_ ? transform_.worldToIndex(world) : world;
        };
        first_ = position(at);
        step_ = position(next) - first_;
    }
    /// Index coordinates of an entry's vertex, snapped.
    openvdb::Vec3d operator()(int entry) const {
        if (bent_)
            return snapped(transform_.worldToIndex(
                lattice_.position({vertex_.x(), vertex_.y(), vertex_.z() + entry})));
        const auto at = first_ + entry * step_;
        return snapped(linear_ ? at : transform_.worldToIndex(at));
    }

    /// A range that holds all entries of the column within a box, and maybe more.
    /// @param box      of voxels; may be empty
    /// @param entries  of the column
    /// @return first 0, last -1 if no entry lies in the box
    Window within(const openvdb::CoordBBox& box, int entries) const {
        constexpr Window none{0, -1};
        if (box.empty()) return none;
        if (bent_) return {0, entries - 1};
        double low = 0, high = entries - 1;
        for (int d = 0; linear_ && d < 3; ++d) {
            const double from = box.min()[d] - first_[d], to = box.max()[d] - first_[d];
            constexpr double hair = 1e-3;  // voxels
            if (std::abs(step_[d]) * entries < hair) {
                if (from > 2 * hair || to < -2 * hair) return none;
                continue;
            }
            low = std::max(low, std::min(from / step_[d], to / step_[d]) - 1);
            high = std::min(high, std::max(from / step_[d], to / step_[d]) + 1);
        }
        if (low > high) return none;
        return {static_cast<int>(low), static_cast<int>(high)};
    }

private:
    const openvdb::math::Transform& transform_;
    const bool linear_, bent_;
    const Lattice& lattice_;
    const Axis axis_;
    openvdb::Vec3d vertex_;        ///< the column's first
    openvdb::Vec3d first_, step_;  ///< index units, or world units if the transform is not linear
};

}  // namespace fluidcarve
