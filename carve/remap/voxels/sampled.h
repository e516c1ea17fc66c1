#pragma once

#include "carve/lattice/mapping.h"
#include "carve/remap/voxels/interpolation.h"
#include "carve/seam/carve_map.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Carves a grid in any position and orientation relative to the lattice (METHOD 4). A voxel at
/// `p`, with lattice coordinates `l`, takes its value at `p + G(M(l)) - G(l)`; `G` maps from the
/// lattice to the grid's index space. In cells whose corners move differently, values are
/// interpolated, not positions. Voxels of cells that do not move are copied bit for bit. Each
/// component of a staggered grid is carved at its own face. Integers, booleans and masks are read
/// from the nearest voxel.
/// Where rims fade, CarveStep::rim_scale moves all source positions towards `l`. Beside a seam,
/// values are blended with the same weights as without such a fade.
/// @param mapping  of the lattice, with the extent map.reach()
/// @param unfaded  the result without a fade of rims, if it is known; only the rest is sampled then
/// @return the grid itself, or `unfaded`, if nothing changes
template <class GridT>
typename GridT::ConstPtr carve_sampled(const typename GridT::ConstPtr& grid, const Mapping& mapping,
                                       const CarveMap& map, Interpolation interpolation,
                                       const typename GridT::ConstPtr& unfaded = nullptr);

}  // namespace fluidcarve
