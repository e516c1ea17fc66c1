#pragma once

#include "nodes/preview/projection.h"

namespace fluidcarve {

/// The part of an index box that lies in a plane across the view; empty if the box does not reach it.
/// @param plane  index coordinate along the view
openvdb::CoordBBox slice_of(const openvdb::CoordBBox& box, View view, int plane);

/// The active values of a grid in a plane of an index space that may be another grid's: those of the nearest voxels.
/// @param space  whose index coordinates `plane` and the result are in
/// @param most   as in blank_projection
/// @return empty if nothing in the plane is near an active voxel
Projection slice_in(const FloatGrid& grid, const openvdb::math::Transform& space, View view, int plane, int most = 1024);

}  // namespace fluidcarve
