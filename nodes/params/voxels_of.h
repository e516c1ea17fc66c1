#pragma once

#include "carve/volume/cubes.h"
#include "carve/volume/volume.h"
#include "graph/types/node_check.h"
#include "graph/types/param.h"

#include <memory>

namespace fluidcarve {

// For nodes that make grids: their voxels are those of a grid `like`, or cubes of `voxel_size`
// along the world's axes, with a centre at its origin.

/// Checks that one of the two is stated.
void check_voxels(const Auto<double>& voxel_size, NodeCheck& check);

/// The transform of the voxels. @param like  null: `voxel_size` counts
openvdb::math::Transform::Ptr voxels_of(const std::shared_ptr<const AnyGrid>& like,
                                        const Auto<double>& voxel_size);

}  // namespace fluidcarve
