#include "carve/sdf/from_points.h"

#include "carve/base/failure.h"
#include "carve/sdf/balls.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetFilter.h>

#include <vector>

namespace fluidcarve {

namespace {

/// Maximum distance of a point from the grid's origin, voxels.
constexpr double farthest_point = 1e9;

/// Index coordinates of points.
/// @throws Failure if one is too far from the grid's origin
std::vector<openvdb::Vec3d> index_coordinates(std::vector<openvdb::Vec3d> positions,
                                              const openvdb::math::Transform& transform) {
    for (auto& position : positions) {
        const auto at = transform.worldToIndex(position);
        if (!(at.length() < farthest_point))
            throw Failure(
                fmt::format("a particle at [{}, {}, {}] is too far from the grid's origin for this "
                            "size of voxels; choose larger voxels, or remove the particle",
                            position.x(), position.y(), position.z()));
        position = at;
    }
    return positions;
}

}  // namespace

FloatGrid::Ptr sdf_of_points(const Points& points, const openvdb::math::Transform& transform,
                             const Splat& splat) {
    const auto centres = index_coordinates(points.positions(), transform);
    const auto out = FloatGrid::create(
        distances_to_balls({centres, splat.radius, splat.half_width}, transform.voxelSize().x()));
    out->setTransform(transform.copy());
    out->setGridClass(openvdb::GRID_LEVEL_SET);
    out->setName("surface");
    if (splat.smoothing > 0 && !out->tree().empty()) {
        openvdb::tools::LevelSetFilter<FloatGrid> filter(*out);
        for (int pass = 0; pass < splat.smoothing; ++pass) filter.mean(1);
    }
    return out;
}

}  // namespace fluidcarve
