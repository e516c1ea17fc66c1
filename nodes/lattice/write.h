#pragma once

#include "graph/types/node_type.h"
#include "nodes/lattice/lattice.h"

#include <array>
#include <string>

namespace fluidcarve {

/// Writes lines through the vertices of a lattice as OBJ, whole or not at all; closed lattices close.
/// @param every  vertices from a line to the next along u, v and w, at least 1; the last always has one
/// @throws Failure
void write_wireframe(const std::string& path, const Lattice& lattice, const std::array<int, 3>& every);

/// `lattice.write`
NodeType lattice_write();

}  // namespace fluidcarve
