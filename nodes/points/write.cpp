#include "nodes/points/write.h"

#include "nodes/geometry_file/usda.h"
#include "nodes/points/file.h"
#include "nodes/points/usda.h"

namespace fluidcarve {

template <>
struct ChoiceNames<PlyEncoding> {
    static constexpr std::array names = {std::pair{"ascii", PlyEncoding::ascii}, std::pair{"little_endian", PlyEncoding::little},
                                         std::pair{"big_endian", PlyEncoding::big}};
};

namespace {

struct PointsWrite {
    struct Params {
        OutputPath path;
        Auto<PlyEncoding> encoding;
        Auto<double> width;
        Auto<Vec3> translate;
        Auto<double> scale;
    };
    struct Ports {
        Ref<Points> source;
        Optional<Volume> beside;
    };

    static void check(const Params& params, NodeCheck& check) {
        const bool ply = names_ply(params.path.text()), usda = names_usda(params.path.text());
        if ((ply || usda) && check.connections("beside") > 0)
            check.fault("beside", fmt::format("a {} file holds points alone; write a .vdb, or the grids with vdb.write", ply ? "PLY" : ".usda"));
        if (!usda && check.stated("width")) check.fault("width", "is for USD files; the path does not end in .usda");
        if (!ply && check.stated("encoding")) check.fault("encoding", "is for PLY files; the path does not end in .ply");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto at = params.translate.value_or(Vec3{});
        const Placement placement{openvdb::Vec3d(at[0], at[1], at[2]), params.scale.value_or(1)};
        const auto path = params.path.at(context.frame());
        const auto* const stated = params.translate || params.scale ? &placement : nullptr;
        if (names_usda(path)) {
            const auto frame = params.path.per_frame() ? std::optional(context.frame()) : std::nullopt;
            const auto unsaid = write_points_usda(path, *io.source, {stated, params.width, frame});
            for (const auto& name : unsaid.attributes)
                context.warn(fmt::format("attribute '{}' is left out: it can't go to USD; write a .vdb to keep it", name));
            if (unsaid.width) context.warn("the .usda file does not tell how wide the points are, and they have no voxels: say 'width'");
            return;
        }
        const auto unsaid = write_points(path, *io.source, io.beside.get(), params.encoding ? &*params.encoding : nullptr, stated, context.provenance());
        for (const auto& name : unsaid.attributes)
            context.warn(fmt::format("attribute '{}' is of a type that PLY can't hold and is left out; write a .vdb to keep it", name));
        if (!unsaid.offset.empty())
            context.warn(
                fmt::format("the file's grids do not tell where the points are against them: read it by points.read with 'offset: {}'", unsaid.offset));
    }
};

}  // namespace

NodeType points_write() {
    return Declare<PointsWrite>("points.write",
                                "Writes points to VDB files, alone or beside other grids, to PLY or to USD files. A file appears whole or not at all.")
        .input("source", &PointsWrite::Ports::source, "The points. Unchanged points are written as they were read.")
        .input("beside", &PointsWrite::Ports::beside,
               "Other grids to write to the same VDB file. The source replaces a point grid of the same name, else it comes last. Blender's files are "
               "recognised by their grids: for particles without `velocity` or `density`, points.read needs `offset: half_voxel`.")
        .required(
            "path", &PointsWrite::Params::path,
            "File, .vdb, .ply or .usda; with a frame token such as #### if the source comes per frame. Missing folders are made. PLY holds no grid metadata, "
            "texts, "
            "matrices or 64-bit integers. Vectors become `name_x`, `name_y`, `name_z`, groups 0 or 1 in `group_name`. Positions in PLY include the offset of "
            "the reader. USD holds what PLY does; usd.write puts such files beside volumes.")
        .param("encoding", &PointsWrite::Params::encoding, "Encoding of PLY files. Auto: as the source's file, or little_endian if that was not PLY.")
        .param("width", &PointsWrite::Params::width, Unit::world, between(1e-9, 1e9),
               "Width of each point in .usda files. Auto: twice its `radius` or `pscale`; without one half a voxel of the points' grid, which PLY files lack.")
        .param("translate", &PointsWrite::Params::translate, Unit::world, any_number(),
               "The placement of a reader to undo. Auto: that of the source's reader; points in .usda files stay in the shot's world.")
        .param("scale", &PointsWrite::Params::scale, Unit::none, between(1e-6, 1e6), "The same for a reader's `scale`.");
}

}  // namespace fluidcarve
