#pragma once

#include "carve/volume/volume.h"

#include <cstdint>

namespace fluidcarve {

/// Resamples all grids, by openvdb::tools::resampleToMatch: floats and vectors linearly, integers
/// and states by the nearest voxel; level sets are rebuilt with their old narrow band. Staggered
/// vectors become collocated; points stay.
/// @param transform  of the new voxels
/// @param budget     memory that a grid's new voxels may take, bytes
/// @throws Failure (input) naming the grid whose new voxels do not fit in memory
Volume resampled(const Volume& volume, const openvdb::math::Transform& transform,
                 std::uint64_t budget);

}  // namespace fluidcarve
