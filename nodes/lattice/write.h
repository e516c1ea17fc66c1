#pragma once

#include "graph/types/node_type.h"
#include "nodes/lattice/lattice.h"

#include <array>
#include <string>

namespace fluidcarve {

/// Writes lines through the vertices of a lattice as an OBJ file, whole or not at all. Lines around a closed lattice close.
/// @param every  distance of neighbouring lines along u, v and w, vertices, at least 1; the last vertex always has a line
/// @throws Failure if the file can't be written
void write_wireframe(const std::string& path, const Lattice& lattice, const std::array<int, 3>& every, const Provenance& provenance = {});

/// `lattice.write`: the node of write_wireframe().
NodeType lattice_write();

}  // namespace fluidcarve
