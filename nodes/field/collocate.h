#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// A staggered velocity (component c of voxel ijk stands on the face at ijk - e_c / 2, OpenVDB's GRID_STAGGERED)
/// brought to the voxel centres: component c is the mean of the faces at ijk and ijk + e_c. Faces that are not active
/// count with the value that they hold. Active voxels, name, transform and background stay; the class becomes unknown.
/// @return the grid itself if it is not staggered
/// @throws Failure naming the grid and voxel if a value is not finite
Ref<VectorGrid> collocated(const Ref<VectorGrid>& velocity);

NodeType field_collocate();

}  // namespace fluidcarve
