#pragma once

#include "carve/seam/seams.h"
#include "carve/volume/volume.h"

#include <vector>

namespace fluidcarve {

/// The grids of a seam file that holds a warp: `warp.0000` and so on, one per frame, or one for
/// all. The voxel `(u, lateral, k)` is a point of the warp, its value the scaled displacement
/// there, vertices. All points are active.
std::vector<VolumeGrid> grids_of_warp(const Warp& warp);

/// Reads such grids. Takes memory only for what they hold.
/// @param seams   give the shape, the frames and whether the lattice is closed
/// @param factor  vertices from point to point
/// @return the warp with its bounds; its scale is 1
/// @throws Failure (input), without the file's name, if a grid is missing or has other points, or
///   if a value is not finite or inverts space
Warp warp_of_grids(const Volume& volume, const Seams& seams, int factor);

}  // namespace fluidcarve
