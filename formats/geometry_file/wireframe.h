#pragma once

#include "carve/lattice/lattice.h"
#include "formats/file/provenance.h"

#include <array>
#include <string>
#include <vector>

namespace fluidcarve {

/// Writes lines through the vertices of a lattice as an OBJ file, whole or not at all: an element
/// `l` for each edge between neighbouring chosen vertices. Lines around a closed lattice, or
/// around a rig, are closed.
/// @param every  distance of neighbouring lines along u, v and w, vertices, at least 1; the last
///   vertex always has a line
/// @throws Failure if the file can't be written
void write_wireframe(const std::string& path, const Lattice& lattice,
                     const std::array<int, 3>& every, const Provenance& provenance = {});

/// The distance of lines, in vertices, that draws about 16 along a dimension.
/// @param count  of vertices
int every_by_default(int count);

/// The vertices along a dimension that get a line: every `every`-th, and always the last one.
std::vector<int> lined_vertices(int count, int every);

}  // namespace fluidcarve
