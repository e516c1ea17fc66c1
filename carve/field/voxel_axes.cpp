#include "carve/field/voxel_axes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

VoxelAxes::VoxelAxes(const openvdb::math::Transform& transform) {
    for (int axis = 0; axis < 3; ++axis) {
        openvdb::Vec3d at(0);
        at[axis] = 1;
        steps_[static_cast<std::size_t>(axis)] =
            transform.indexToWorld(at) - transform.indexToWorld(openvdb::Vec3d(0));
    }
    // Of the six ways the one with the largest sum of cosines; of equal ones the first.
    constexpr double more = 1e-9;
    std::array<int, 3> order{0, 1, 2};
    double best = -1;
    do {
        double sum = 0;
        for (int world = 0; world < 3; ++world) {
            const auto& along = step(order[static_cast<std::size_t>(world)]);
            sum += std::abs(along[world]) / along.length();
        }
        if (sum > best + more) {
            best = sum;
            order_ = order;
        }
    } while (std::ranges::next_permutation(order).found);
}

}  // namespace fluidcarve
