#include "carve/volume/cubes.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {

openvdb::math::Transform::Ptr cubes_of(double edge) {
    if (!(edge >= least_voxel))
        throw Failure(fmt::format(
            "voxels of {:g} world units are too small, {:g} is the least; scale the scene", edge,
            least_voxel));
    return openvdb::math::Transform::createLinearTransform(edge);
}

double shortest_edge(const openvdb::math::Transform& transform) {
    const auto size = transform.voxelSize();
    return std::min({size.x(), size.y(), size.z()});
}

}  // namespace fluidcarve
