#pragma once

#include "carve/lattice/lattice.h"
#include "carve/mesh/mesh.h"
#include "carve/seam/carve_map.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// The part of a mesh that a carve distorts.
struct MeshStrain {
    double share = 0;  ///< of all edges or faces, 0 to 1
    double worst = 0;  ///< in vertices of the lattice
};

/// A carved mesh, and where the carve distorts it.
struct CarvedMesh {
    Mesh mesh;
    /// Edges longer than two vertices' distance whose ends are displaced differently, by half a
    /// vertex or more. A seam runs through such an edge, but the edge stays straight. Worst: the
    /// longest edge.
    MeshStrain stretched;
    /// Faces with an edge across a rim: one end moves by half a vertex or more, the other one lies
    /// outside the lattice and stays. Worst: the longest displacement.
    MeshStrain torn;
};

/// Moves the vertices of a mesh as a carve moves space (METHOD 6): from `p` to `p + g(l*) - g(l)`,
/// where `l = f(p)`, and `l*` are its carved_coordinates(). Vertices outside the lattice, or where
/// nothing moves, stay to the last bit. Faces and attributes stay.
CarvedMesh carve_mesh(const Mesh& mesh, const Lattice& lattice, const CarveMap& map);

/// Warnings about distortions; empty if there are none. Numbers are coarse, so that similar frames
/// give the same warnings.
std::vector<std::string> warnings_of(const CarvedMesh& carved);

}  // namespace fluidcarve
