#pragma once

#include "carve/field/filter.h"
#include "carve/seam/carve_map.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// Smooths a carved volume along its seams (paper 5.1.2; METHOD 5). Active voxels in, or on the
/// border of, cells whose corners are displaced differently take the filtered value. All other
/// voxels stay bit for bit. Active states stay. Each component of a staggered grid is looked up at
/// its face; in aligned boxes, at its voxel. Grids of integers, booleans and masks, and grids that
/// can't be carved, do not change.
/// @param volume  carved by `map`
/// @param mode    as in field.filter; inactive voxels count with their stored value
/// @param width   half width of the filter's cube, voxels, at least 1
/// @throws Failure naming the grid and voxel if a value that is not finite lies within the filter's
///   reach of a seam
Volume seam_filtered(const Volume& volume, const Lattice& lattice, const CarveMap& map,
                     FilterMode mode, int width);

}  // namespace fluidcarve
