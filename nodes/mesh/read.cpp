#include "nodes/mesh/read.h"

#include "nodes/io/file_sequence.h"
#include "nodes/mesh/mesh_file.h"
#include "nodes/mesh/topology.h"

#include <fmt/format.h>

namespace fluidcarve {
namespace {

struct MeshRead {
    struct Params {
        InputPath path;
        Missing missing = Missing::error;
        Vec3 translate{};
        double scale = 1;
    };
    struct Ports {
        Ref<Mesh> mesh;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (const auto fault = ending_fault(params.path.text()); !fault.empty()) check.fault("path", fault);
        check_missing(params.path, params.missing, check);
    }

    static void survey(const Params& params, Survey& survey) {
        survey_files(params.path, params.missing, survey, [&](int, int file) { probe_mesh(params.path.at(file)); });
    }

    static void run(const Params& params, Ports& io, Context& context) {
        auto file = read_mesh(file_of(params.path, params.missing, context));
        for (const auto& loss : file.losses) context.warn(loss);
        if (const auto faults = faults_of(topology_of(file.mesh)); !faults.empty()) context.warn(faults + ": they are kept as they are");
        io.mesh = std::make_shared<Mesh>(placed(std::move(file.mesh), {openvdb::Vec3d(params.translate.data()), params.scale}));
    }
};

}  // namespace

NodeType mesh_read() {
    using Params = MeshRead::Params;
    return Declare<MeshRead>("mesh.read", "Reads polygon meshes: OBJ, PLY, OFF, STL, with UVs, normals, colours, groups and materials.")
        .required("path", &Params::path, "A .obj, .ply, .off or .stl file, or a sequence with a frame token such as ####.")
        .param("missing", &Params::missing, missing_doc)
        .param("translate", &Params::translate, Unit::world, any_number(),
               "Position of the file's origin in the shot's world; the writer undoes it. Meshes of Blender's liquid caches are in units of the domain's "
               "longest side, around its centre: set `scale` to the cells along the longest side times the voxel size, and `translate` to the domain's low "
               "corner plus half its cells times the voxel size (`file_base_resolution` and `file_voxel_size` of its grids).")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), "World units of the shot per unit of the file, applied before `translate`.")
        .output("mesh", &MeshRead::Ports::mesh, "The mesh. No faces or vertices are merged, split or turned.");
}

}  // namespace fluidcarve
