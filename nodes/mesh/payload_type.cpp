#include "nodes/mesh/payload_type.h"

#include "nodes/mesh/mesh.h"

namespace fluidcarve {

void add_mesh_payload(Registry& registry) {
    registry.add(payload_type<Mesh>("mesh", "Polygons with what their file says of vertices, faces and corners: UVs, normals, colours.", [](const Mesh& mesh) {
        auto out = mesh.points.size() * sizeof(openvdb::Vec3d) + mesh.corners.size() * sizeof(std::uint32_t) + mesh.ends.size() * sizeof(std::size_t);
        for (const auto& attribute : mesh.attributes) out += attribute.values.size() * sizeof(double) + attribute.at.size() * sizeof(std::uint32_t);
        return out;
    }));
}

}  // namespace fluidcarve
