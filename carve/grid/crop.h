#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// All grids without what lies outside of a box, by openvdb::GridBase::clipGrid; points stay.
/// @param box  world units; of turned voxels, the box around it along their axes counts
Volume cropped(const Volume& volume, const openvdb::BBoxd& box);

}  // namespace fluidcarve
