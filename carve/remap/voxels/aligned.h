#pragma once

#include "carve/lattice/alignment.h"
#include "carve/seam/carve_map.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Carves a grid whose voxels are the lattice's vertices one to one: classical seam carving, by
/// voxel indices. Values and states are copied, except inserted entries: these get the mean of
/// their neighbours (in grids of integers, booleans and masks the lower neighbour's value) and are
/// active if either neighbour is. Under a smoothed step, values are interpolated between two
/// voxels, and components of a staggered grid move from their faces; else they travel with their
/// voxel.
/// @param alignment  one_to_one()
/// @return the grid itself if nothing changes
template <class GridT>
typename GridT::ConstPtr carve_aligned(const typename GridT::ConstPtr& grid,
                                       const Alignment& alignment, const CarveMap& map);

}  // namespace fluidcarve
