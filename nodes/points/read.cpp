#include "nodes/points/read.h"

#include "nodes/io/file_sequence.h"
#include "nodes/points/file.h"

namespace fluidcarve {

template <>
struct ChoiceNames<PointOffset> {
    static constexpr std::array names = {std::pair{"auto", PointOffset::detect}, std::pair{"none", PointOffset::none},
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
        if (names_ply(params.path.text()) && check.stated("offset")) check.fault("offset", "is for VDB files; a PLY file has its points where they are");
    }

    static void survey(const Params& params, Survey& survey) {
        survey_files(params.path, params.missing, survey, [&](int, int file) { look_at_points(params.path.at(file), params.grid); });
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const Placement placement{openvdb::Vec3d(params.translate[0], params.translate[1], params.translate[2]), params.scale};
        io.points = std::make_shared<Points>(read_points(file_of(params.path, params.missing, context), params.grid, params.offset, placement));
    }
};

}  // namespace

NodeType points_read() {
    return Declare<PointsRead>("points.read", "Reads points: particles with all their attributes, from VDB files or the vertices of PLY files.")
        .required("path", &PointsRead::Params::path, "File, or sequence with a frame token such as ####. Use vdb.read for other grids of a VDB file.")
        .param("grid", &PointsRead::Params::grid, "Name of the point grid in a VDB file. Not needed if there is only one.")
        .param("missing", &PointsRead::Params::missing, missing_doc)
        .param("offset", &PointsRead::Params::offset,
               "Offset of a VDB file's points relative to its other grids. none: positions as in the file. half_voxel: half a voxel lower along each axis, as "
               "in Blender's liquids. Auto recognises Blender's files by their grids: `particles` or `shadow`, together with `velocity` or `density`; state "
               "half_voxel for Blender files with particles alone. Writers of VDB files undo the offset.")
        .param("translate", &PointsRead::Params::translate, Unit::world, any_number(),
               "Position of the file's origin in the shot's world, as for vdb.read of the same file; the writer undoes it.")
        .param("scale", &PointsRead::Params::scale, Unit::none, between(1e-6, 1e6), "World units of the shot per unit of the file, applied before `translate`.")
        .output("points", &PointsRead::Ports::points, "The points, with all attributes, groups and metadata.");
}

}  // namespace fluidcarve
