#pragma once

#include "nodes/mesh/mesh.h"

namespace fluidcarve {

/// How the faces of a mesh hang together.
struct Topology {
    std::size_t boundary_edges = 0;      ///< at which an odd number of faces ends
    std::size_t non_manifold_faces = 0;  ///< at an edge with more than two faces or faces of opposite turns, or at a vertex where fans of faces meet
    std::size_t degenerate_faces = 0;    ///< that have a vertex twice
    std::size_t lone_vertices = 0;       ///< without a face

    /// Whether the faces enclose a space, so that there is an inside, however they are turned and wherever they meet.
    bool closed() const { return boundary_edges == 0; }
};

/// Joins the faces to a half-edge mesh (OpenMesh), in their order; a face that does not fit those before it is non-manifold.
/// Degenerate faces are left out of it.
Topology topology_of(const Mesh& mesh);

/// Topology::boundary_edges alone.
std::size_t boundary_edges(const Mesh& mesh);

/// What is unusual, in words, or empty. Boundaries and lone vertices are not.
std::string faults_of(const Topology& topology);

}  // namespace fluidcarve
