#pragma once

#include "carve/remap/finish/derivative.h"
#include "carve/remap/voxels/places.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Smooths a carved level set where it was squeezed (METHOD 5): the stair-steps of its voxels
/// became steeper there, and would show as ripple. Active voxels that were not squeezed stay bit
/// for bit.
/// @param grid        of floats or doubles
/// @param places      of the grid's voxels
/// @param derivative  exact()
/// @return the grid itself if nothing changes
openvdb::GridBase::ConstPtr squeezed_smooth(const openvdb::GridBase::ConstPtr& grid,
                                            const CarvedPlaces& places,
                                            const CarveDerivative& derivative);

}  // namespace fluidcarve
