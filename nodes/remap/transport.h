#pragma once

#include "nodes/remap/carved_places.h"
#include "nodes/remap/derivative.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

// For carved grids (METHOD 5). `D` is CarveDerivative at a voxel, or at a component's face. Active voxels where there is no
// derivative, and all inactive ones, stay bit for bit; states stay.

/// A density that keeps its mass: value times |det D|.
/// @param grid  of floats or doubles, amounts per volume
/// @return the grid itself if nothing changes
openvdb::GridBase::ConstPtr mass_kept(const openvdb::GridBase::ConstPtr& grid, const CarvedPlaces& places, const CarveDerivative& derivative);

/// Velocities turned and stretched with the space in which they stand: `D^-1` times the vector. On the faces of a staggered
/// grid the other two components are the means of the nearest four.
/// @param grid  of float or double vectors, world units by any other
/// @return the grid itself if nothing changes
openvdb::GridBase::ConstPtr vectors_turned(const openvdb::GridBase::ConstPtr& grid, const CarvedPlaces& places, const CarveDerivative& derivative);

}  // namespace fluidcarve
