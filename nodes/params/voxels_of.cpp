#include "nodes/params/voxels_of.h"

namespace fluidcarve {

void check_voxels(const Auto<double>& voxel_size, NodeCheck& check) {
    const bool like = check.connections("like") > 0;
    if (!like && !voxel_size)
        check.fault("type", "needs 'voxel_size', or a grid 'like' whose voxels it takes");
    if (like && voxel_size)
        check.fault("voxel_size",
                    "'like' already states the voxels; leave 'like' or 'voxel_size' out");
}

openvdb::math::Transform::Ptr voxels_of(const std::shared_ptr<const AnyGrid>& like,
                                        const Auto<double>& voxel_size) {
    return like ? like->grid->transform().copy() : cubes_of(*voxel_size);
}

}  // namespace fluidcarve
