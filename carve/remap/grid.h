#pragma once

#include "carve/remap/voxels/sampled.h"
#include "carve/seam/carve_map.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// Carves a grid (METHOD 4): by voxel indices if its voxels are the lattice's vertices
/// (voxels/aligned.h) and its rims do not fade, else by sampling (voxels/sampled.h). Name, class,
/// transform, half flag and all other metadata stay.
/// @return the grid itself if nothing changes
/// @throws Failure if values of its type can't be carved
openvdb::GridBase::ConstPtr carve_grid(const openvdb::GridBase::ConstPtr& grid,
                                       const Lattice& lattice, const CarveMap& map,
                                       Interpolation interpolation);

/// Carves all grids of a volume. Grids that do not change are shared.
Volume carve_volume(const Volume& volume, const Lattice& lattice, const CarveMap& map,
                    Interpolation interpolation);

}  // namespace fluidcarve
