#pragma once

#include "carve/points/points.h"
#include "carve/remap/finish/derivative.h"
#include "carve/remap/voxels/places.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

// These functions take carved grids and points (METHOD 5). `D` is the CarveDerivative at a voxel,
// at a component's face, or at a point. Active voxels without a derivative stay bit for bit. So do
// inactive voxels, except those that receive some of a density: these become active.

/// Scales a density by |det D|, so that it keeps its mass. If the content of several voxels is
/// compressed into one, the result is the mean over several positions in that voxel, each with its
/// own value in `source`. A single position would mostly be too thin, since seams avoid dense
/// content.
/// @param source  before the carve, of the same type and transform as `grid`
/// @param grid    of floats or doubles, amounts per volume
/// @return the grid itself if nothing changes
openvdb::GridBase::ConstPtr mass_kept(const openvdb::GridBase::ConstPtr& source,
                                      const openvdb::GridBase::ConstPtr& grid,
                                      const CarvedPlaces& places,
                                      const CarveDerivative& derivative);

/// Turns and stretches velocities with the space around them: `D^-1` times the vector. On the faces
/// of a staggered grid, the other two components are the means of the nearest four.
/// @param grid  of float or double vectors, world units per any other unit
/// @return the grid itself if nothing changes
openvdb::GridBase::ConstPtr vectors_turned(const openvdb::GridBase::ConstPtr& grid,
                                           const CarvedPlaces& places,
                                           const CarveDerivative& derivative);

/// The same for the velocities of points (velocity_name). Points without velocities do not change.
Points vectors_turned(const Points& points, const CarveDerivative& derivative);

}  // namespace fluidcarve
