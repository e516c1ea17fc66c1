#pragma once

#include "nodes/lattice/lattice.h"
#include "nodes/mesh/mesh.h"
#include "nodes/seams/carve_map.h"

namespace fluidcarve {

/// A part of a mesh to which a carve does more than to move it.
struct MeshStrain {
    double share = 0;  ///< of all edges, or faces, 0 to 1
    double worst = 0;  ///< vertices of the lattice
};

struct CarvedMesh {
    Mesh mesh;
    /// Edges longer than two vertices' distance whose ends move by amounts that differ by half a vertex or more: a seam runs
    /// through them, but they stay straight. Worst: the longest.
    MeshStrain stretched;
    /// Faces across a rim: some of their vertices move by half a vertex or more, others lie beyond the lattice and stay.
    /// Worst: the longest way that one moves.
    MeshStrain torn;
};

/// Moves vertices as a carve moves space (METHOD 6): from `p` to `p + g(l*) - g(l)`, `l = f(p)` and `l*` its carved_coordinates. Vertices
/// beside the lattice, or where nothing moves, stay to the last bit; faces and attributes stay.
CarvedMesh carve_mesh(const Mesh& mesh, const Lattice& lattice, const CarveMap& map);

/// What to tell of it, in steps so coarse that frames that are much alike say the same; empty if there is nothing.
std::vector<std::string> warnings_of(const CarvedMesh& carved);

}  // namespace fluidcarve
