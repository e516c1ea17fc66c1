#include "nodes/payload/add_payloads.h"

#include "carve/mesh/mesh.h"
#include "carve/stream/mesh_stream.h"

namespace fluidcarve {

void add_mesh_payload(Registry& registry) {
    registry.add(payload_type<Mesh>(
        "mesh", "Polygons with attributes of vertices, faces and corners: UVs, normals, colours.",
        &Stored<Mesh>::bytes, {1, &Stored<Mesh>::write, &Stored<Mesh>::read}));
}

}  // namespace fluidcarve
