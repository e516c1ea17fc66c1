#include "formats/vdb/vdb_parts.h"

#include <fmt/format.h>

namespace fluidcarve {

void check_own_metadata(const openvdb::GridBase& grid) {
    using openvdb::GridBase;
    const auto text = openvdb::StringMetadata::staticTypeName(),
               flag = openvdb::BoolMetadata::staticTypeName();
    for (const auto& [name, type] : {std::pair(GridBase::META_GRID_CLASS, text),
                                     {GridBase::META_GRID_CREATOR, text},
                                     {GridBase::META_GRID_NAME, text},
                                     {GridBase::META_VECTOR_TYPE, text},
                                     {GridBase::META_SAVE_HALF_FLOAT, flag},
                                     {GridBase::META_IS_LOCAL_SPACE, flag}})
        if (const auto meta = grid[name]; meta && meta->typeName() != type)
            throw std::runtime_error(
                fmt::format("its metadata '{}' has the type {}, but must have the type {}", name,
                            meta->typeName(), type));
}

bool agrees_with_itself(const openvdb::math::Transform& transform) {
    if (!transform.isLinear()) return true;
    constexpr double tolerance = 0.01;  // voxels: far from the origin positions are coarse
    const auto origin = transform.indexToWorld(openvdb::Vec3d(0));
    for (int axis = 0; axis < 3; ++axis) {
        openvdb::Vec3d step(0);
        step[axis] = 1;
        const auto to = transform.indexToWorld(step);
        const auto edge = transform.voxelSize()[axis];
        if (!(edge > 0 && std::abs((to - origin).length() - edge) <= tolerance * edge &&
              (transform.worldToIndex(to) - step).length() <= tolerance))
            return false;
    }
    return true;
}

}  // namespace fluidcarve
