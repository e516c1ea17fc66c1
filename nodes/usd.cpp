#include "nodes/usd.h"

#include "carve/base/words.h"
#include "formats/geometry_file/usda.h"
#include "formats/usd/stage.h"
#include "nodes/params/placement_params.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace fluidcarve {

template <>
struct ChoiceNames<UsdStage::Up> {
    static constexpr std::array names = {std::pair{"y", UsdStage::Up::y},
                                         std::pair{"z", UsdStage::Up::z}};
};

namespace {

struct UsdWrite {
    struct Params {
        OutputPath path;
        WrittenPaths files;
        double fps = 24;
        UsdStage::Up up = UsdStage::Up::z;
        double metres_per_unit = 1;
        Auto<Vec3> translate;
        Auto<double> scale;
    };
    struct Ports {
        OptionalNamed<Volume> volumes;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (ending_of(params.path.text()) != ".usda")
            check.fault("path", fmt::format("writes a .usda file, not '{}'",
                                            ending_of(params.path.text())));
        if (params.files.empty())
            check.fault("files", "holds files together, but 'files' names none");
        const auto volumes = check.names("volumes");
        for (const auto& name : volumes)
            if (!params.files.contains(name))
                check.fault(
                    "volumes",
                    fmt::format("needs the file of volume '{0}': name it in 'files: {{{0}: ...}}'",
                                name));
        for (const auto& [name, file] : params.files) {
            const auto ending = ending_of(file.text());
            const bool volume = std::ranges::find(volumes, name) != volumes.end();
            if (!is_usd_name(name))
                check.fault(
                    "files",
                    fmt::format(
                        "can't name a prim '{}'; use letters, digits and _, and no digit first",
                        name));
            if (ending != ".vdb" && ending != ".usda")
                check.fault("files", fmt::format("takes .vdb and .usda files, not {}; mesh.write "
                                                 "and points.write make .usda files, too",
                                                 file.text()));
            else if (volume && ending != ".vdb")
                check.fault("files", fmt::format("needs the .vdb file of volume '{}', not {}", name,
                                                 file.text()));
            else if (!volume && ending == ".vdb")
                check.fault("files", fmt::format("needs what {1} holds: connect what its writer "
                                                 "takes, as in 'volumes: {{{0}: NODE}}'",
                                                 name, file.text()));
        }
    }

    /// One frame tells which grids there are. So a part of the frames gives the same file as all
    /// of them.
    static NodeTraits traits(const Params&) {
        return {.takes = [](const Context& context) {
            return context.t() == typical_place(context.frames().size());
        }};
    }

    void add(const Params& params, const Ports& io, Context& context) {
        const auto placement = stated_placement(params);
        for (const auto& [name, volume] : io.volumes) {
            auto fields = usd_fields(*volume, placement ? &*placement : nullptr);
            for (const auto& left_out : fields.left_out)
                context.warn(
                    fmt::format("grid '{}' of volume '{}' is left out: USD has no type for it; "
                                "points come in by points.write, as a .usda file",
                                left_out, name));
            if (fields.fields.empty())
                context.warn(fmt::format("volume '{}' shows nothing: it has no grids in frame {}",
                                         name, context.frame()));
            fields_.insert_or_assign(name, std::move(fields));
        }
    }

    void finish(const Params& params, Ports&, Context& context) {
        UsdStage stage{context.frames(), params.fps, params.up, params.metres_per_unit, {}};
        for (const auto& [name, file] : params.files) {
            const auto found = fields_.find(name);
            stage.parts.push_back(
                {name, file, found == fields_.end() ? std::nullopt : std::optional(found->second)});
        }
        const auto path = params.path.at(context.frame());
        write_usda(path, stage_text(stage, path), context.provenance());
    }

private:
    std::map<std::string, UsdFields> fields_;  ///< by the name of the volume
};

}  // namespace

NodeType usd_write() {
    using Params = UsdWrite::Params;
    return Declare<UsdWrite>(
               "usd.write",
               "Writes one .usda file that holds a shot together, for Solaris, usdview and "
               "Omniverse: volumes in .vdb files, meshes and points in .usda files. It names the "
               "files of all frames of the sequence, whichever of them a run delivers. The file "
               "appears whole or not at all.")
        .input("volumes", &UsdWrite::Ports::volumes,
               "What the .vdb files hold, by the names in `files`: what their vdb.write takes. "
               "Grids and their types are those of the middle frame. Grids of points are left out.")
        .required("path", &Params::path,
                  "The .usda file, one for all frames. It names other files as they lie from "
                  "there. Missing folders are made.")
        .required("files", &Params::files,
                  "Files that other nodes of the pipeline write, each with the name of its prim: "
                  "`{smoke: out/smoke.####.vdb, bank: out/bank.####.usda}`. Attributes of meshes "
                  "and points are those of the middle frame.")
        .param("fps", &Params::fps, Unit::none, between(0.001, 1000), "Frames per second.")
        .param("up", &Params::up,
               "The shot's axis that points up. In Blender it is z, in Houdini y.")
        .param("meters_per_unit", &Params::metres_per_unit, Unit::none, between(1e-9, 1e9),
               "Length of a world unit in metres.")
        .param("translate", &Params::translate, Unit::world, any_number(),
               "Where the .vdb files' space is in the shot's world, as stated at vdb.write: "
               "volumes are moved there. Auto: by what the reader of their grids was told.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), "The same for `scale`.");
}

}  // namespace fluidcarve
