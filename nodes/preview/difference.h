#pragma once

#include "nodes/preview/projection.h"

namespace fluidcarve {

/// After minus before, voxel by voxel in index space, and of each line of sight the difference of largest size, with
/// its sign: a cell is 0 only if nothing changes all along its line. (The difference of two maximum projections would
/// hide all changes behind a maximum that stays.) Compared are the voxels that are active in either grid; in the other
/// one its inactive value counts, mostly the background. Of vectors: the difference of their lengths.
/// @param box, most  as in blank_projection; a box one voxel deep makes it a slice
/// @return NaN where nothing is active; differences that are NaN are passed over
Projection largest_difference(const FloatGrid& before, const FloatGrid& after, View view, const openvdb::CoordBBox& box, int most = 1024);
Projection largest_difference(const VectorGrid& before, const VectorGrid& after, View view, const openvdb::CoordBBox& box, int most = 1024);

}  // namespace fluidcarve
