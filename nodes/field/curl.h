#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// The axis and twice the rate of a flow's spin, by central differences (paper eq. 11).
/// @param velocity  world units per second, in cubic voxels along the world's axes; a staggered grid is collocated first.
///                  Beyond its active voxels the values that it holds count (0, in most files)
/// @return 1/s, on the active voxels of `velocity`
/// @throws Failure naming the grid if its voxels are no cubes or a value is not finite
VectorGrid::Ptr curl_field(const Ref<VectorGrid>& velocity);

NodeType field_curl();

}  // namespace fluidcarve
