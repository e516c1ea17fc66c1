#include "nodes/mesh/write.h"

#include "nodes/geometry_file/usda.h"
#include "nodes/mesh/mesh_file.h"
#include "nodes/mesh/usda.h"

namespace fluidcarve {
namespace {

struct MeshWrite {
    struct Params {
        OutputPath path;
        Auto<Vec3> translate;
        Auto<double> scale;
    };
    struct Ports {
        Ref<Mesh> source;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (names_usda(params.path.text())) return;
        if (const auto fault = ending_fault(params.path.text()); !fault.empty()) check.fault("path", fault + "; for USD, write a .usda file");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const Placement placement{openvdb::Vec3d(params.translate.value_or(Vec3{}).data()), params.scale.value_or(1)};
        const auto* const stated = params.translate || params.scale ? &placement : nullptr;
        const auto path = params.path.at(context.frame());
        const auto frame = params.path.per_frame() ? std::optional(context.frame()) : std::nullopt;
        const auto losses = names_usda(path) ? write_mesh_usda(path, *io.source, stated, frame) : write_mesh(path, *io.source, stated, context.provenance());
        for (const auto& loss : losses) context.warn(loss);
    }
};

}  // namespace

NodeType mesh_write() {
    using Params = MeshWrite::Params;
    return Declare<MeshWrite>("mesh.write", "Writes polygon meshes: OBJ, PLY, OFF, STL, USD. A file appears whole or not at all.")
        .input("source", &MeshWrite::Ports::source,
               "The mesh. In the format of its file it is written as it was read: positions of vertices that did not move, faces and their order, UVs, groups, "
               "materials. A warning names what another format can't hold.")
        .required(
            "path", &Params::path,
            "A .obj, .ply, .off, .stl or .usda file; with a frame token such as #### if the source comes per frame. Missing folders are made. Meshes in .usda "
            "files are not subdivided; usd.write puts them beside volumes.")
        .param("translate", &Params::translate, Unit::world, any_number(),
               "The placement of a reader to undo. Auto: that of the mesh's reader; meshes made by nodes, and those in .usda files, stay in the shot's world.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), "The same for a reader's `scale`.");
}

}  // namespace fluidcarve
