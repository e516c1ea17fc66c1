#pragma once

#include "nodes/lattice/mapping.h"
#include "nodes/seams/carve_map.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// How a grid is read between its voxels: by 2^3, 3^3 or 4^3 of them (Catmull-Rom).
enum class Interpolation { linear, quadratic, cubic };

/// Carves a grid that lies anyhow to the lattice (METHOD 4): a voxel at `p`, lattice coordinates `l`, takes its value
/// at `p + G(M(l)) - G(l)`, `G` from lattice to the grid's index space. In cells whose corners move differently,
/// values are interpolated and not positions. Voxels of cells that do not move are copied bit for bit. Each component
/// of a staggered grid is carved at its own face. Whole numbers, booleans and masks are read from the nearest voxel.
/// @param mapping  of the lattice, with the extent map.reach()
/// Where the map fades, everything that would be read is drawn towards `l` by CarveStep::scale; beside a seam, values
/// are blended with the same weights.
/// @param unfaded  what the grid becomes where nothing fades, if that is known; only the rest is sampled then
/// @return the grid itself, or `unfaded`, if nothing changes
template <class GridT>
typename GridT::ConstPtr carve_sampled(const typename GridT::ConstPtr& grid, const Mapping& mapping, const CarveMap& map, Interpolation interpolation,
                                       const typename GridT::ConstPtr& unfaded = nullptr);

}  // namespace fluidcarve
