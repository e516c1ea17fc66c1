#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// A mask grown or shrunk along all axes and diagonals, so that a cube stays a cube
/// (openvdb::tools, 26 neighbours).
/// @param voxels  above 0: adds all voxels within this distance along each axis; below 0: removes
///   all voxels that have a voxel outside of the mask within this distance
MaskGrid::Ptr dilated_mask(const MaskGrid& mask, int voxels);

}  // namespace fluidcarve
