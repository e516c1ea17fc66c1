#pragma once

#include "carve/mesh/edges.h"
#include "carve/mesh/mesh.h"

namespace fluidcarve {

/// Counts of topological faults of a mesh.
struct Topology {
    std::size_t boundary_edges = 0;      ///< edges with an odd number of faces
    std::size_t non_manifold_faces = 0;  ///< faces at an edge with more than two or oppositely
                                         ///< oriented faces, or at a vertex shared by several fans
    std::size_t degenerate_faces = 0;    ///< faces that have a vertex twice

    /// Whether the faces enclose a space, so that the mesh has an inside, whatever their
    /// orientation.
    bool closed() const { return boundary_edges == 0; }
};

/// Counts the faults of a mesh. Faces are added in order to a half-edge mesh (OpenMesh); a face
/// that does not fit those before it counts as non-manifold. Degenerate faces are not added.
Topology topology_of(const Mesh& mesh);

/// The faults in words, or empty. Boundary edges do not count as faults.
std::string faults_of(const Topology& topology);

}  // namespace fluidcarve
