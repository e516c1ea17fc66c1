#pragma once

#include "nodes/preview/projection.h"

namespace fluidcarve {

/// The part of an index box in a plane across the view; empty if they do not meet.
/// @param plane  index coordinate along the view
openvdb::CoordBBox slice_of(const openvdb::CoordBBox& box, View view, int plane);

/// The active values of a grid in a plane of another grid's index space, by nearest voxel.
/// @param space  transform of the index space of `plane` and the result
/// @param plane  index coordinate along the view
/// @param most   as in blank_projection
/// @return empty if the plane meets no active voxel
Projection slice_in(const FloatGrid& grid, const openvdb::math::Transform& space, View view,
                    int plane, int most = 1024);

}  // namespace fluidcarve
