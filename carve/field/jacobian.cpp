#include "carve/field/jacobian.h"

#include "carve/base/failure.h"
#include "carve/field/same_transform.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {

Jacobian::Jacobian(const openvdb::GridBase& grid) {
    const auto& transform = grid.constTransform();
    if (!transform.isLinear())
        throw Failure(
            fmt::format("grid '{}' has voxels of varying shape ({}); derivatives need voxels of "
                        "one shape, as grid.resample makes them",
                        grid.getName(), transform.mapType()));
    const auto by_voxel = transform.baseMap()->getAffineMap()->getMat4().getMat3();
    cubes_ = are_cubes(transform);
    plain_ = cubes_along_axes(transform);
    edge_ = plain_ ? transform.voxelSize().x() : std::cbrt(std::abs(by_voxel.det()));
    half_ = static_cast<float>(1 / (2 * edge_));
    // OpenVDB multiplies rows: world = index * by_voxel, so that row i is the step along index axis
    // i.
    by_world_ =
        plain_ ? openvdb::Mat3d(openvdb::Mat3d::identity() * (1 / edge_)) : by_voxel.inverse();
}

}  // namespace fluidcarve
