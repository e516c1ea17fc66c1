#include "carve/mask/mesh.h"

#include "carve/base/failure.h"
#include "carve/mask/threshold.h"
#include "carve/mesh/edges.h"
#include "carve/mesh/made_once.h"
#include "carve/sdf/from_mesh.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetUtil.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace fluidcarve {

namespace {

constexpr double least_band = 3;  ///< voxels; wide enough for signs to be right everywhere

}  // namespace

MaskGrid::Ptr inside_mask(const Mesh& mesh, const openvdb::math::Transform& transform) {
    if (const auto open = boundary_edges(mesh); open > 0)
        throw Failure(
            fmt::format("the mesh is not closed, so that it has no inside: an odd number of faces "
                        "meets at {} edges; close it, or set `where: near`",
                        open));
    const auto distance = mesh_distance(mesh, transform, least_band, std::nullopt);
    const auto inside = openvdb::tools::sdfInteriorMask(distance->tree(), 0.0f);
    const auto out = MaskGrid::create(
        std::make_shared<openvdb::MaskTree>(*inside, false, true, openvdb::TopologyCopy()));
    out->setTransform(transform.copy());
    out->setName("inside");
    return out;
}

MaskGrid::Ptr near_mask(const Mesh& mesh, const openvdb::math::Transform& transform,
                        double distance) {
    const auto around = mesh_distance_unsigned(
        mesh, transform, std::max(least_band, distance / transform.voxelSize().x() + 1));
    const auto out = threshold_mask(*around, 0, distance);
    out->setName("near");
    return out;
}

}  // namespace fluidcarve
