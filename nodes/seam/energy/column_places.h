#pragma once

#include "nodes/lattice/lattice.h"
#include "nodes/lattice/mapping.h"

#include <openvdb/math/Transform.h>

#include <array>

namespace fluidcarve {

/// Finds the vertices of a column in a grid's index space. If the grid's transform is linear, they stand on a line at equal distances.
class ColumnPlaces {
public:
    ColumnPlaces(const openvdb::math::Transform& transform, const Lattice& lattice, Axis axis)
        : transform_(transform), linear_(transform_.isLinear()), lattice_(lattice), axis_(axis) {}

    /// Moves to a column.
    /// @param first  the column's first vertex (i, j, k)
    void move_to(const std::array<int, 3>& first) {
        const openvdb::Vec3d at(first[0], first[1], first[2]);
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
        const auto at = first_ + entry * step_;
        return snapped(linear_ ? at : transform_.worldToIndex(at));
    }

private:
    const openvdb::math::Transform& transform_;
    const bool linear_;
    const Lattice& lattice_;
    const Axis axis_;
    openvdb::Vec3d first_, step_;  ///< index units, or world units if the transform is not linear
};

}  // namespace fluidcarve
