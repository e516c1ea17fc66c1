#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// Clips all grids to a box, as openvdb::GridBase::clipGrid does, and to `farthest_voxel`; points
/// stay.
/// @param box  world units; a rotated grid is clipped to the bounding box along its own axes
Volume cropped(const Volume& volume, const openvdb::BBoxd& box);

}  // namespace fluidcarve
