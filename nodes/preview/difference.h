#pragma once

#include "nodes/preview/projection.h"

namespace fluidcarve {

/// Projects `after - before`, voxel by voxel in index space: each cell shows the difference of
/// largest magnitude along its line of sight, with its sign. A cell is 0 only if nothing changes
/// along its line. (The difference of two maximum projections would hide changes behind an
/// unchanged maximum.) Compares all voxels that are active in either grid; inactive voxels count
/// with their stored value. For vectors, the difference of their lengths.
/// @param box, most  as in blank_projection; a box one voxel deep gives a slice
/// @return NaN where no voxel is active. Differences that are NaN are ignored
Projection largest_difference(const FloatGrid& before, const FloatGrid& after, View view,
                              const openvdb::CoordBBox& box, int most = 1024);
Projection largest_difference(const VectorGrid& before, const VectorGrid& after, View view,
                              const openvdb::CoordBBox& box, int most = 1024);

}  // namespace fluidcarve
