#include "formats/mesh_file/topology.h"

#include <fmt/format.h>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include <algorithm>
#include <mutex>

namespace fluidcarve {

namespace {

using HalfEdges = OpenMesh::PolyMesh_ArrayKernelT<>;

/// Disables OpenMesh's error messages about refused faces: they are counted instead.
void silence() {
    static std::once_flag once;
    std::call_once(once, [] { omerr().disable(); });
}

}  // namespace

Topology topology_of(const Mesh& mesh) {
    silence();
    Topology out;
    HalfEdges joined;
    joined.reserve(mesh.points.size(), mesh.corners.size(), mesh.faces());
    for (std::size_t n = 0; n < mesh.points.size(); ++n) joined.new_vertex();
    std::vector<HalfEdges::VertexHandle> corners;
    std::vector<std::uint32_t> sorted;
    for (std::size_t n = 0; n < mesh.faces(); ++n) {
        const auto face = mesh.face(n);
        sorted.assign(face.begin(), face.end());
        std::ranges::sort(sorted);
        if (std::ranges::adjacent_find(sorted) != sorted.end()) {
            ++out.degenerate_faces;
            continue;
        }
        corners.clear();
        for (const auto vertex : face) corners.emplace_back(static_cast<int>(vertex));
        if (!joined.add_face(corners).is_valid()) ++out.non_manifold_faces;
    }
    out.boundary_edges = boundary_edges(mesh);
    return out;
}

std::string faults_of(const Topology& topology) {
    std::string out;
    const auto add = [&](std::size_t count, const std::string& what) {
        if (count > 0)
            out += fmt::format("{}{} {} {}", out.empty() ? "" : ", and ", count,
                               count == 1 ? "face" : "faces", what);
    };
    add(topology.non_manifold_faces,
        "beyond two at an edge, turned against their neighbours, or touching others at a vertex "
        "alone");
    add(topology.degenerate_faces, "with a vertex twice");
    return out;
}

}  // namespace fluidcarve
