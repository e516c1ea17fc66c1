#pragma once

#include "carve/remap/voxels/places.h"
#include "carve/seam/carve_map.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Whether a grid is a level set that can be renormalised: float or double values, cubic voxels, a
/// background above 0, of 100 voxels at most.
bool can_renormalize(const openvdb::GridBase& grid);

/// Makes a carved level set a distance again where the carve moved it (METHOD 5), by
/// openvdb::tools::LevelSetTracker. It solves the Eikonal equation in the voxels that moved, and
/// keeps all others bit for bit. Where voxels moved, the narrow band becomes the voxels nearer than
/// the background: it closes where a carve cut it open, grows where it was compressed and shrinks
/// where it was stretched.
/// @param grid    carved by `map`; satisfies can_renormalize()
/// @param places  of the grid's voxels
/// @return the grid itself if nothing changes
/// @throws Failure as require_near
openvdb::GridBase::ConstPtr renormalized(const openvdb::GridBase::ConstPtr& grid,
                                         const CarvedPlaces& places, const CarveMap& map);

}  // namespace fluidcarve
