#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// A mask grown or shrunk along all axes and diagonals: a cube stays a cube (openvdb::tools, 26 neighbours).
/// @param voxels  above 0, the mask holds all that is within so many voxels of it along each axis; below 0, it keeps only what
///                has no voxel outside of the mask so near
MaskGrid::Ptr dilated_mask(const MaskGrid& mask, int voxels);

NodeType mask_dilate();

}  // namespace fluidcarve
