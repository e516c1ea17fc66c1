#pragma once

#include "carve/base/words.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>

namespace fluidcarve {

/// Assigns each index axis of a grid to the nearest world axis, so that results do not depend on
/// the order in which voxels are stored.
class VoxelAxes {
public:
    /// @param transform  linear
    explicit VoxelAxes(const openvdb::math::Transform& transform);

    /// Step from a voxel to the next along an index axis, world units.
    const openvdb::Vec3d& step(int axis) const { return steps_[static_cast<std::size_t>(axis)]; }
    /// The index axis assigned to a world axis. Its direction may be opposite.
    int nearest(int world) const { return order_[static_cast<std::size_t>(world)]; }

private:
    std::array<openvdb::Vec3d, 3> steps_;
    std::array<int, 3> order_{0, 1, 2};
};

}  // namespace fluidcarve
