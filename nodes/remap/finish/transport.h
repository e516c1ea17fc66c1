#pragma once

#include "nodes/remap/finish/derivative.h"
#include "nodes/remap/voxels/places.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

// For carved grids (METHOD 5). `D` is CarveDerivative at a voxel, or at a component's face. Active voxels where there is no
// derivative stay bit for bit, and so do inactive ones, but those into which some of a density is pressed: they become active.

/// A density that keeps its mass: value times |det D|. Where a voxel holds what several held before, it is the mean over several places
/// in it, each with its own value in `source`: seams avoid what is dense, so that one place would mostly be thin.
/// @param source  before the carve, of the same type and transform as `grid`
/// @param grid    of floats or doubles, amounts per volume
/// @return the grid itself if nothing changes
openvdb::GridBase::ConstPtr mass_kept(const openvdb::GridBase::ConstPtr& source, const openvdb::GridBase::ConstPtr& grid, const CarvedPlaces& places,
                                      const CarveDerivative& derivative);

/// Velocities turned and stretched with the space in which they stand: `D^-1` times the vector. On the faces of a staggered
/// grid the other two components are the means of the nearest four.
/// @param grid  of float or double vectors, world units by any other
/// @return the grid itself if nothing changes
openvdb::GridBase::ConstPtr vectors_turned(const openvdb::GridBase::ConstPtr& grid, const CarvedPlaces& places, const CarveDerivative& derivative);

}  // namespace fluidcarve
