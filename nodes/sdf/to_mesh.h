#pragma once

#include "graph/types/node_type.h"
#include "nodes/mesh/mesh.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// The surface on which a grid has a value: quads, and where flat parts are coarsened triangles too. Faces are turned outwards: to
/// where values rise in level sets and grids whose background is larger than the value, to where they fall in others.
/// @param isovalue    in the grid's unit
/// @param adaptivity  0: a quad per voxel; to 1: ever fewer, where the surface is flat
Mesh surface_mesh(const FloatGrid& grid, double isovalue, double adaptivity);

NodeType sdf_to_mesh();

}  // namespace fluidcarve
