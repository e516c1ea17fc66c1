#include "nodes/mesh/write.h"

#include "nodes/mesh/mesh_file.h"

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
        if (const auto fault = ending_fault(params.path.text()); !fault.empty()) check.fault("path", fault);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const Placement placement{openvdb::Vec3d(params.translate.value_or(Vec3{}).data()), params.scale.value_or(1)};
        const bool stated = params.translate || params.scale;
        for (const auto& loss : write_mesh(params.path.at(context.frame()), *io.source, stated ? &placement : nullptr, context.provenance()))
            context.warn(loss);
    }
};

}  // namespace

NodeType mesh_write() {
    using Params = MeshWrite::Params;
    return Declare<MeshWrite>("mesh.write", "Writes polygon meshes: OBJ, PLY, OFF, STL. A file appears whole or not at all.")
        .input("source", &MeshWrite::Ports::source,
               "The mesh. In the format of its file it is written as it was read: positions of vertices that did not move, faces and their order, UVs, groups, "
               "materials. A warning names what another format can't hold.")
        .required("path", &Params::path,
                  "A .obj, .ply, .off or .stl file; with a frame token such as #### if the source comes per frame. Missing folders are made.")
        .param("translate", &Params::translate, Unit::world, any_number(),
               "The placement of a reader to undo. Auto: that of the mesh's reader; meshes made by nodes stay in the shot's world.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), "The same for a reader's `scale`.");
}

}  // namespace fluidcarve
