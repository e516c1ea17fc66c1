#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

#include <vector>

namespace fluidcarve {

/// What lies below the surfaces of several level sets, seen along a direction (paper 6.0.2): in each line of voxels along it all
/// from `depth` below the uppermost voxel that any of them has inside, down to where the lowest of them is known. What lies beneath
/// an overhang, or a drop in the air, is below too.
/// @param surfaces  of one transform, below 0 inside; at least one
/// @param up        along an axis of their voxels
/// @param depth     world units, rounded to voxels, at least 0
/// @throws Failure if `up` runs along no axis, transforms differ, or a grid is a density
MaskGrid::Ptr below_surface_mask(const std::vector<Ref<FloatGrid>>& surfaces, const openvdb::Vec3d& up, double depth);

NodeType mask_below_surface();

}  // namespace fluidcarve
