#pragma once

#include "carve/mesh/mesh.h"

#include <cstddef>

namespace fluidcarve {

/// Only Topology::boundary_edges.
std::size_t boundary_edges(const Mesh& mesh);

}  // namespace fluidcarve
