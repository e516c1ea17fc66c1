#include "nodes/mesh.h"

#include "carve/base/words.h"
#include "formats/mesh_file/mesh_file.h"
#include "formats/mesh_file/topology.h"
#include "formats/mesh_file/usda.h"
#include "graph/types/node_type.h"
#include "nodes/params/file_sequence.h"
#include "nodes/params/placement_params.h"

#include <fmt/format.h>

#include <optional>

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
        if (const auto fault = ending_fault(params.path.text()); !fault.empty())
            check.fault("path", fault);
        check_missing(params.path, params.missing, check);
    }

    static void survey(const Params& params, Survey& survey) {
        survey_files(params.path, params.missing, survey,
                     [&](int, int file) { probe_mesh(params.path.at(file)); });
    }

    static void run(const Params& params, Ports& io, Context& context) {
        auto file = read_mesh(file_of(params.path, params.missing, context));
        for (const auto& loss : file.losses) context.warn(loss);
        if (const auto faults = faults_of(topology_of(file.mesh)); !faults.empty())
            context.warn(faults + ": they are kept as they are");
        io.mesh = std::make_shared<Mesh>(placed(std::move(file.mesh), placement_of(params)));
    }
};

}  // namespace

NodeType mesh_read() {
    using Params = MeshRead::Params;
    return Declare<MeshRead>("mesh.read",
                             "Reads polygon meshes: OBJ, PLY, OFF, STL, with UVs, normals, "
                             "colours, groups and materials.")
        .required("path", &Params::path,
                  fmt::format("A {} file, or a sequence with a frame token such as ####.",
                              either(all_mesh_endings())))
        .param("missing", &Params::missing, missing_doc)
        .param("translate", &Params::translate, Unit::world, any_number(),
               "Position of the file's origin in the shot's world; the writer undoes it. Meshes of "
               "Blender's liquid caches are in units of the domain's longest side, around its "
               "centre: set `scale` to the cells along the longest side times the voxel size, and "
               "`translate` to the domain's low corner plus half its cells times the voxel size "
               "(`file_base_resolution` and `file_voxel_size` of its grids).")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), placed_scale_doc)
        .output("mesh", &MeshRead::Ports::mesh,
                "The mesh. No faces or vertices are merged, split or turned.");
}

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
        if (ending_of(params.path.text()) == ".usda") return;
        if (const auto fault = ending_fault(params.path.text()); !fault.empty())
            check.fault("path", fault + "; for USD, write a .usda file");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto placement = stated_placement(params);
        const auto* const stated = placement ? &*placement : nullptr;
        const auto path = params.path.at(context.frame());
        const auto frame = params.path.per_frame() ? std::optional(context.frame()) : std::nullopt;
        const auto provenance = context.provenance();
        const auto losses = ending_of(path) == ".usda"
                                ? write_mesh_usda(path, *io.source, stated, frame, provenance)
                                : write_mesh(path, *io.source, stated, provenance);
        for (const auto& loss : losses) context.warn(loss);
    }
};

}  // namespace

NodeType mesh_write() {
    using Params = MeshWrite::Params;
    auto endings = all_mesh_endings();
    endings.emplace_back(".usda");
    return Declare<MeshWrite>("mesh.write",
                              "Writes polygon meshes: OBJ, PLY, OFF, STL, USD. A file appears "
                              "whole or not at all.")
        .input("source", &MeshWrite::Ports::source,
               "The mesh. In the format of its file it is written as it was read: positions of "
               "vertices that did not move, faces and their order, UVs, groups, materials. A "
               "warning names what another format can't hold.")
        .required("path", &Params::path,
                  fmt::format(
                      "A {} file; with a frame token such as #### if the source comes per "
                      "frame. Missing folders are made. Meshes in .usda files are not subdivided; "
                      "usd.write puts them beside volumes.",
                      either(endings)))
        .param("translate", &Params::translate, Unit::world, any_number(),
               "The placement of a reader to undo. Auto: that of the mesh's reader; meshes made by "
               "nodes, and those in .usda files, stay in the shot's world.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), undone_scale_doc);
}

}  // namespace fluidcarve
