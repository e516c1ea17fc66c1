#pragma once

#include "carve/mesh/mesh.h"

#include <cstddef>

namespace fluidcarve {

/// Topology::boundary_edges, without the rest of the topology.
std::size_t boundary_edges(const Mesh& mesh);

}  // namespace fluidcarve
