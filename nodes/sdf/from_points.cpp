#include "nodes/sdf/from_points.h"

#include "nodes/field/stencil.h"
#include "nodes/field/voxels_of.h"
#include "nodes/sdf/balls.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetFilter.h>

namespace fluidcarve {
namespace {

/// Maximum distance of a point from the grid's origin, voxels.
constexpr double farthest_point = 1e9;

/// Index coordinates of points.
/// @throws Failure if one is too far from the grid's origin
std::vector<openvdb::Vec3d> index_coordinates(std::vector<openvdb::Vec3d> positions, const openvdb::math::Transform& transform) {
    for (auto& position : positions) {
        const auto at = transform.worldToIndex(position);
        if (!(at.length() < farthest_point))
            throw Failure(fmt::format(
                "a particle at [{}, {}, {}] is too far from the grid's origin for this size of voxels; choose larger voxels, or remove the particle",
                position.x(), position.y(), position.z()));
        position = at;
    }
    return positions;
}

struct FromPoints {
    struct Params {
        Auto<double> voxel_size;
        double radius = Splat{}.radius;
        int smoothing = Splat{}.smoothing;
        double half_width = Splat{}.half_width;
    };
    struct Ports {
        Ref<Points> points;
        Optional<AnyGrid> like;
        Ref<FloatGrid> surface;
    };

    static void check(const Params& params, NodeCheck& check) { check_voxels(params.voxel_size, check); }

    static void run(const Params& params, Ports& io, Context&) {
        if (io.like) require_cubes(*io.like->grid);
        const auto transform = voxels_of(io.like, params.voxel_size);
        io.surface = sdf_of_points(*io.points, *transform, {params.radius, params.smoothing, params.half_width});
    }
};

}  // namespace

FloatGrid::Ptr sdf_of_points(const Points& points, const openvdb::math::Transform& transform, const Splat& splat) {
    const auto centres = index_coordinates(points.positions(), transform);
    const auto out = FloatGrid::create(distances_to_balls({centres, splat.radius, splat.half_width}, transform.voxelSize().x()));
    out->setTransform(transform.copy());
    out->setGridClass(openvdb::GRID_LEVEL_SET);
    out->setName("surface");
    if (splat.smoothing > 0 && !out->tree().empty()) {
        openvdb::tools::LevelSetFilter<FloatGrid> filter(*out);
        for (int pass = 0; pass < splat.smoothing; ++pass) filter.mean(1);
    }
    return out;
}

NodeType sdf_from_points() {
    return Declare<FromPoints>("sdf.from_points", "The surface of particles: the distance to balls around them, as a level set.")
        .input("points", &FromPoints::Ports::points, "The particles. A frame without particles has no surface.")
        .input("like", &FromPoints::Ports::like, "The surface takes the voxels of this grid, such as the particles' velocity. Only its transform counts.")
        .param("voxel_size", &FromPoints::Params::voxel_size, Unit::world, between(least_voxel, 1e9),
               "Edge of a voxel, instead of `like`. A voxel centre is at the world's origin.")
        .param("radius", &FromPoints::Params::radius, Unit::voxels, between(0.5, 100),
               "Radius of the balls. If particles are about half a voxel apart, as in most liquids, 1 to 2 gives a closed surface.")
        .param("smoothing", &FromPoints::Params::smoothing, Unit::none, between(0, 100), "Number of times that the surface is averaged over 3 x 3 x 3 voxels.")
        .param("half_width", &FromPoints::Params::half_width, Unit::voxels, between(2, 100),
               "Half width of the narrow band: distances are known this far from the surface, on each side.")
        .output("surface", &FromPoints::Ports::surface, "The distance to the surface, world units, negative inside.")
        .kept();
}

}  // namespace fluidcarve
