#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// The voxels whose centres lie in a box along the world's axes, or on its border.
/// @param like  the mask takes its transform
/// @param min, max  corners, world units, min <= max
/// @return a mask named "box"
/// @throws Failure as convex_mask
MaskGrid::Ptr box_mask(const openvdb::GridBase& like, const openvdb::Vec3d& min,
                       const openvdb::Vec3d& max);

}  // namespace fluidcarve
