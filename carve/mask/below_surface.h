#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <vector>

namespace fluidcarve {

/// The voxels below the surfaces of level sets (paper 6.0.2). In each line of voxels along `up`,
/// the mask begins `depth` below the uppermost voxel that is inside any of them, and ends at the
/// lowest active voxel of all. Voxels beneath an overhang, or beneath a drop in the air, are below
/// too.
/// @param surfaces  at least one, all with the same transform, negative inside
/// @param up        direction along an axis of the voxels, any length
/// @param depth     world units, rounded to voxels, at least 0
/// @throws Failure if `up` is not along an axis, transforms differ, or a grid is a fog volume
MaskGrid::Ptr below_surface_mask(const std::vector<Ref<FloatGrid>>& surfaces,
                                 const openvdb::Vec3d& up, double depth);

}  // namespace fluidcarve
