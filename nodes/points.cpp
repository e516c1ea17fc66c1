#include "nodes/points.h"

#include "carve/base/words.h"
#include "carve/points/keep_out.h"
#include "carve/points/points.h"
#include "carve/volume/volume.h"
#include "formats/points_file/points_file.h"
#include "formats/points_file/usda.h"
#include "graph/types/node_type.h"
#include "nodes/params/file_sequence.h"
#include "nodes/params/placement_params.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <optional>

namespace fluidcarve {

namespace {

struct KeepOut {
    struct Params {};
    struct Ports {
        Ref<Points> source;
        Ref<FloatGrid> solid;
        Ref<Points> points;
    };
    static void run(const Params&, Ports& io, Context& context) {
        if (io.solid->getGridClass() != openvdb::GRID_LEVEL_SET)
            throw Failure(
                fmt::format("grid '{}' is no level set and does not say where it is solid; make "
                            "one, by sdf.from_mesh for one",
                            io.solid->getName()));
        auto kept = kept_out(*io.source, *io.solid);
        const nlohmann::ordered_json counts{
            {"points", io.source->size()}, {"moved", kept.moved}, {"stuck", kept.stuck}};
        context.report("points", {{context.frame_name(), counts}});
        if (kept.stuck > 0)
            context.warn(
                "some points lie so deep in the solid that its distances do not say which way is "
                "out, and stay; give it a wider `half_width`");
        io.points = kept.moved > 0 ? std::make_shared<Points>(std::move(kept.points)) : io.source;
    }
};

}  // namespace

NodeType points_keep_out() {
    return Declare<KeepOut>("points.keep_out",
                            "Moves particles inside a solid out to its surface, for example where "
                            "a carve moved water and bank by slightly different amounts.")
        .input("source", &KeepOut::Ports::source,
               "The particles. Those outside of the solid stay bit for bit.")
        .input("solid", &KeepOut::Ports::solid,
               "A level set, negative inside, such as sdf.from_mesh of the carved bank.")
        .output(
            "points", &KeepOut::Ports::points,
            "The particles. None is in the solid, except those too deep in it for its narrow band "
            "to show the way out. The report's section `points` counts moved and stuck particles.");
}

template <>
struct ChoiceNames<PointOffset> {
    static constexpr std::array names = {std::pair{"auto", PointOffset::detect},
                                         std::pair{"none", PointOffset::none},
                                         std::pair{"half_voxel", PointOffset::half_voxel}};
};

namespace {

struct PointsRead {
    struct Params {
        InputPath path;
        std::string grid;
        Missing missing = Missing::error;
        PointOffset offset = PointOffset::detect;
        Vec3 translate{};
        double scale = 1;
    };
    struct Ports {
        Ref<Points> points;
    };

    static void check(const Params& params, NodeCheck& check) {
        check_missing(params.path, params.missing, check);
        if (ending_of(params.path.text()) == ".ply" && check.stated("offset"))
            check.fault("offset", "is for VDB files; a PLY file has its points where they are");
    }

    static void survey(const Params& params, Survey& survey) {
        survey_files(params.path, params.missing, survey,
                     [&](int, int file) { probe_points(params.path.at(file), params.grid); });
    }

    static void run(const Params& params, Ports& io, Context& context) {
        io.points =
            std::make_shared<Points>(read_points(file_of(params.path, params.missing, context),
                                                 params.grid, params.offset, placement_of(params)));
    }
};

}  // namespace

NodeType points_read() {
    return Declare<PointsRead>("points.read",
                               "Reads points: particles with all their attributes, from VDB files "
                               "or the vertices of PLY files.")
        .required("path", &PointsRead::Params::path,
                  "File, or sequence with a frame token such as ####. Use vdb.read for other grids "
                  "of a VDB file.")
        .param("grid", &PointsRead::Params::grid,
               "Name of the point grid in a VDB file. Not needed if there is only one.")
        .param("missing", &PointsRead::Params::missing, missing_doc)
        .param("offset", &PointsRead::Params::offset,
               "Offset of a VDB file's points relative to its other grids. none: positions as in "
               "the file. half_voxel: half a voxel lower along each axis, as in Blender's liquids. "
               "Auto recognises Blender's files by their grids: `particles` or `shadow`, together "
               "with `velocity` or `density`; state half_voxel for Blender files with particles "
               "alone. Writers of VDB files undo the offset.")
        .param("translate", &PointsRead::Params::translate, Unit::world, any_number(),
               "Position of the file's origin in the shot's world, as for vdb.read of the same "
               "file; the writer undoes it.")
        .param("scale", &PointsRead::Params::scale, Unit::none, between(1e-6, 1e6),
               placed_scale_doc)
        .output("points", &PointsRead::Ports::points,
                "The points, with all attributes, groups and metadata.");
}

template <>
struct ChoiceNames<NumberForm> {
    static constexpr std::array names = {std::pair{"ascii", NumberForm::ascii},
                                         std::pair{"little_endian", NumberForm::little},
                                         std::pair{"big_endian", NumberForm::big}};
};

namespace {

struct PointsWrite {
    struct Params {
        OutputPath path;
        Auto<NumberForm> encoding;
        Auto<double> width;
        Auto<Vec3> translate;
        Auto<double> scale;
    };
    struct Ports {
        Ref<Points> source;
        Optional<Volume> beside;
    };

    static void check(const Params& params, NodeCheck& check) {
        const auto ending = ending_of(params.path.text());
        const bool ply = ending == ".ply", usda = ending == ".usda";
        if ((ply || usda) && check.connections("beside") > 0)
            check.fault(
                "beside",
                fmt::format(
                    "a {} file holds points alone; write a .vdb, or the grids with vdb.write",
                    ply ? "PLY" : ".usda"));
        if (!usda && check.stated("width"))
            check.fault("width", "is for USD files; the path does not end in .usda");
        if (!ply && check.stated("encoding"))
            check.fault("encoding", "is for PLY files; the path does not end in .ply");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto path = params.path.at(context.frame());
        const auto placement = stated_placement(params);
        const auto* const stated = placement ? &*placement : nullptr;
        if (ending_of(path) == ".usda") {
            const auto frame =
                params.path.per_frame() ? std::optional(context.frame()) : std::nullopt;
            const auto losses = write_points_usda(
                path, *io.source, {stated, params.width, frame, context.provenance()});
            for (const auto& name : losses.attributes)
                context.warn(fmt::format(
                    "attribute '{}' is left out: it can't go to USD; write a .vdb to keep it",
                    name));
            if (losses.width)
                context.warn(
                    "the .usda file does not state how wide the points are, and they have no "
                    "voxels: state 'width'");
            return;
        }
        const auto losses = write_points(path, *io.source, io.beside.get(),
                                         params.encoding ? &*params.encoding : nullptr, stated,
                                         context.provenance());
        for (const auto& name : losses.attributes)
            context.warn(
                fmt::format("attribute '{}' is of a type that PLY can't hold and is left out; "
                            "write a .vdb to keep it",
                            name));
        if (!losses.offset.empty())
            context.warn(fmt::format(
                "points.read needs 'offset: {}' for this file: without it, it reads the "
                "points half a voxel off",
                losses.offset));
    }
};

}  // namespace

NodeType points_write() {
    return Declare<PointsWrite>("points.write",
                                "Writes points to VDB files, alone or beside other grids, to PLY "
                                "or to USD files. A file appears whole or not at all.")
        .input("source", &PointsWrite::Ports::source,
               "The points. Unchanged points are written as they were read.")
        .input("beside", &PointsWrite::Ports::beside,
               "Other grids to write to the same VDB file. The source replaces a point grid of the "
               "same name, else it comes last. Blender's files are recognised by their grids: for "
               "particles without `velocity` or `density`, points.read needs `offset: half_voxel`.")
        .required("path", &PointsWrite::Params::path,
                  "File, .vdb, .ply or .usda; with a frame token such as #### if the source comes "
                  "per frame. Missing folders are made. PLY holds no grid metadata, texts, "
                  "matrices or 64-bit integers. Vectors become `name_x`, `name_y`, `name_z`, "
                  "groups 0 or 1 in `group_name`. Positions in PLY include the offset of the "
                  "reader. USD holds what PLY does; usd.write puts such files beside volumes.")
        .param("encoding", &PointsWrite::Params::encoding,
               "Encoding of PLY files. Auto: as the source's file, or little_endian if that was "
               "not PLY.")
        .param("width", &PointsWrite::Params::width, Unit::world, between(1e-9, 1e9),
               "Width of each point in .usda files. Auto: twice its `radius` or `pscale`; without "
               "one half a voxel of the points' grid, which PLY files lack.")
        .param("translate", &PointsWrite::Params::translate, Unit::world, any_number(),
               "The placement of a reader to undo. Auto: that of the source's reader; points in "
               ".usda files stay in the shot's world.")
        .param("scale", &PointsWrite::Params::scale, Unit::none, between(1e-6, 1e6),
               undone_scale_doc);
}

}  // namespace fluidcarve
