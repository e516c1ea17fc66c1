#pragma once

#include "carve/mesh/mesh.h"

#include <cstddef>

namespace fluidcarve {

/// Number of edges with an odd number of faces; 0: the mesh is closed.
std::size_t boundary_edges(const Mesh& mesh);

}  // namespace fluidcarve
