#include "nodes/points/write.h"

#include "nodes/points/file.h"

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
        Auto<Vec3> translate;
        Auto<double> scale;
    };
    struct Ports {
        Ref<Points> source;
        Optional<Volume> beside;
    };

    static void check(const Params& params, NodeCheck& check) {
        const bool ply = names_ply(params.path.text());
        if (ply && check.connections("beside") > 0) check.fault("beside", "a PLY file holds points alone; write a .vdb, or the grids with vdb.write");
        if (!ply && check.stated("encoding")) check.fault("encoding", "is for PLY files; the path does not end in .ply");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto at = params.translate.value_or(Vec3{});
        const Placement placement{openvdb::Vec3d(at[0], at[1], at[2]), params.scale.value_or(1)};
        const auto unsaid = write_points(params.path.at(context.frame()), *io.source, io.beside.get(), params.encoding ? &*params.encoding : nullptr,
                                         params.translate || params.scale ? &placement : nullptr);
        for (const auto& name : unsaid.attributes)
            context.warn(fmt::format("attribute '{}' is of a type that PLY can't hold and is left out; write a .vdb to keep it", name));
        if (!unsaid.offset.empty())
            context.warn(
                fmt::format("the file's grids do not tell where the points are against them: read it by points.read with 'offset: {}'", unsaid.offset));
    }
};

}  // namespace

NodeType points_write() {
    return Declare<PointsWrite>("points.write", "Writes points to VDB files, alone or beside other grids, or to PLY files. A file appears whole or not at all.")
        .input("source", &PointsWrite::Ports::source, "The points; what nothing changed is written as it was read.")
        .input("beside", &PointsWrite::Ports::beside,
               "Other grids to write to the same VDB file. A grid of points of the same name among them gives its place to the source; otherwise the points "
               "come last. Blender's files are known by their grids: of its particles without `velocity` or `density` points.read must be told `offset: "
               "half_voxel`.")
        .required(
            "path", &PointsWrite::Params::path,
            "File, .vdb or .ply; with a frame token such as #### if the source comes per frame. Folders are made. PLY keeps no grid metadata, and neither "
            "texts, matrices nor whole numbers of 64 bits; it takes vectors as `name_x`, `name_y`, `name_z` and groups as 0 or 1 in `group_name`, and "
            "positions where the points are against their grids.")
        .param("encoding", &PointsWrite::Params::encoding, "Of PLY files. Auto: as they were read, little_endian if they were not PLY.")
        .param("translate", &PointsWrite::Params::translate, Unit::world, any_number(), "Undoes this placement of a reader. Auto undoes what the reader did.")
        .param("scale", &PointsWrite::Params::scale, Unit::none, between(1e-6, 1e6), "As `translate`.");
}

}  // namespace fluidcarve
