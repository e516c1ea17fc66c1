#include "nodes/mask/mesh.h"

#include "graph/text/problem.h"
#include "nodes/field/stencil.h"
#include "nodes/mask/threshold.h"
#include "nodes/mesh/made_once.h"
#include "nodes/mesh/topology.h"
#include "nodes/sdf/from_mesh.h"

#include <openvdb/tools/LevelSetUtil.h>

#include <cmath>

namespace fluidcarve {
namespace {

enum class Where { inside, near };

}  // namespace

template <>
struct ChoiceNames<Where> {
    static constexpr std::array names = {std::pair{"inside", Where::inside}, std::pair{"near", Where::near}};
};

namespace {

struct MaskMesh {
    struct Params {
        Where where = Where::inside;
        double distance = 0;
    };
    struct Ports {
        Ref<Mesh> mesh;
        Ref<AnyGrid> like;
        Ref<MaskGrid> mask;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.where == Where::inside && check.stated("distance")) check.fault("distance", "'distance' is only for `where: near`");
        if (params.where == Where::near && params.distance == 0) check.fault("where", "`where: near` needs a 'distance' above 0");
    }

    void run(const Params& params, Ports& io, Context&) const {
        require_cubes(*io.like->grid);
        const auto& transform = io.like->grid->transform();
        io.mask = made_(io.mesh, transform,
                        [&] { return params.where == Where::inside ? inside_mask(*io.mesh, transform) : near_mask(*io.mesh, transform, params.distance); });
    }

private:
    MadeOnce<MaskGrid> made_;
};

constexpr double least_band = 3;  ///< voxels; wide enough for signs to be right everywhere

}  // namespace

MaskGrid::Ptr inside_mask(const Mesh& mesh, const openvdb::math::Transform& transform) {
    if (const auto topology = topology_of(mesh); !topology.closed())
        throw Failure(fmt::format("the mesh is not closed, so that it has no inside: an odd number of faces meets at {} edges; close it, or set `where: near`",
                                  topology.boundary_edges));
    const auto distance = mesh_distance(mesh, transform, least_band, std::nullopt);
    const auto inside = openvdb::tools::sdfInteriorMask(distance->tree(), 0.0f);
    const auto out = MaskGrid::create(std::make_shared<openvdb::MaskTree>(*inside, false, true, openvdb::TopologyCopy()));
    out->setTransform(transform.copy());
    out->setName("inside");
    return out;
}

MaskGrid::Ptr near_mask(const Mesh& mesh, const openvdb::math::Transform& transform, double distance) {
    const auto around = mesh_distance_unsigned(mesh, transform, std::max(least_band, distance / transform.voxelSize().x() + 1));
    const auto out = threshold_mask(*around, 0, distance);
    out->setName("near");
    return out;
}

NodeType mask_mesh() {
    using Params = MaskMesh::Params;
    return Declare<MaskMesh>("mask.mesh", "The voxels in a mesh, or near its faces: where seams are wanted, or kept out.")
        .input("mesh", &MaskMesh::Ports::mesh, "A closed mesh; with `where: near`, any mesh.")
        .input("like", &MaskMesh::Ports::like, "The mask takes the voxels of this grid, such as the energy. Only its transform counts.")
        .param("where", &Params::where, "inside: voxels whose centres the mesh encloses. near: voxels at most `distance` from a face, on either side.")
        .param("distance", &Params::distance, Unit::world, at_least(0), "Maximum distance from a face, for `where: near`.")
        .output("mask", &MaskMesh::Ports::mask, "The voxels in the mesh, or near its faces.")
        .kept();
}

}  // namespace fluidcarve
