#pragma once

#include "nodes/lattice/alignment.h"
#include "nodes/seams/carve_map.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Carves a grid whose voxels are the lattice's vertices one to one: classical seam carving, in whole numbers only.
/// Values and states are copied, never computed, but for inserted entries: the mean of their neighbours (of whole
/// numbers, booleans and masks the lower neighbour), active if either is. Components of a staggered grid travel with
/// their voxel.
/// @return the grid itself if nothing changes
template <class GridT>
typename GridT::ConstPtr carve_aligned(const typename GridT::ConstPtr& grid, const Alignment& alignment, const CarveMap& map);

}  // namespace fluidcarve
