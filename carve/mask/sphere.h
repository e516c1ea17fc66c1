#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// The voxels whose centres lie in a ball, or on its border.
/// @param like  the mask takes its transform
/// @param center, radius  world units, radius >= 0
/// @return a mask named "sphere"
/// @throws Failure as convex_mask
MaskGrid::Ptr sphere_mask(const openvdb::GridBase& like, const openvdb::Vec3d& center,
                          double radius);

}  // namespace fluidcarve
