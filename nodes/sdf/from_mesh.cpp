#include "nodes/sdf/from_mesh.h"

#include "graph/problem.h"
#include "nodes/field/stencil.h"
#include "nodes/mesh/topology.h"
#include "nodes/mesh/triangles.h"

#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {
namespace {

using openvdb::Vec3I;
using openvdb::Vec3s;

constexpr double most_voxels = 1e9;
constexpr double farthest = 1 << 22;  ///< voxels from the origin, where floats still tell halves apart

/// The mesh as triangles in the grid's index space.
struct Triangles {
    std::vector<Vec3s> points;
    std::vector<Vec3I> corners;

    Triangles(const Mesh& mesh, const openvdb::math::Transform& transform, double band) {
        points.reserve(mesh.points.size());
        double reach = 0;
        for (const auto& point : mesh.points) {
            const auto at = transform.worldToIndex(point);
            for (int c = 0; c < 3; ++c) reach = std::max(reach, std::abs(at[c]));
            points.emplace_back(at);
        }
        if (!(reach <= farthest))
            throw Failure(fmt::format("the mesh reaches {:.3g} voxels away from the grid's origin: more than {:.0f} can't be told apart; choose larger voxels",
                                      reach, farthest));
        std::vector<std::array<std::uint32_t, 3>> parts;
        double area = 0;
        for (std::size_t n = 0; n < mesh.faces(); ++n) {
            triangulate(mesh.points, mesh.face(n), parts);
            for (const auto& [a, b, c] : parts) {
                corners.emplace_back(a, b, c);
                area += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).length();
            }
        }
        if (!(2 * band * area <= most_voxels))
            throw Failure(
                fmt::format("the mesh's narrow band would take about {:.1e} voxels, more than {:.0e}; choose larger voxels", 2 * band * area, most_voxels));
    }
};

FloatGrid::Ptr distance(const Mesh& mesh, const openvdb::math::Transform& transform, double band, int flags) {
    const Triangles triangles(mesh, transform, band);
    const openvdb::tools::QuadAndTriangleDataAdapter<Vec3s, Vec3I> faces(triangles.points, triangles.corners);
    openvdb::util::NullInterrupter uninterrupted;
    const auto width = static_cast<float>(band);
    const auto out = openvdb::tools::meshToVolume<FloatGrid>(uninterrupted, faces, transform, width, width, flags);
    out->setName("surface");
    return out;
}

struct SdfFromMesh {
    struct Params {
        Auto<double> voxel_size;
        double band = 3;
        Auto<double> thickness;
    };
    struct Ports {
        Ref<Mesh> mesh;
        Optional<AnyGrid> like;
        Ref<FloatGrid> surface;
    };

    static void check(const Params& params, NodeCheck& check) {
        const bool like = check.connections("like") > 0;
        if (!like && !params.voxel_size) check.fault("type", "needs 'voxel_size', or a grid 'like' whose voxels it takes");
        if (like && params.voxel_size) check.fault("voxel_size", "the voxels are those of 'like'; leave one of the two out");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto transform = io.like ? io.like->grid->transform().copy() : openvdb::math::Transform::createLinearTransform(*params.voxel_size);
        if (io.like) cubic_voxel_size(*io.like->grid);
        if (const auto topology = topology_of(*io.mesh); !params.thickness && !topology.closed() && io.mesh->faces() > 0)
            context.warn("the mesh is not closed, so that it has no inside: the distances have no sign; state a `thickness` for a shell around its faces");
        io.surface = mesh_distance(*io.mesh, *transform, params.band, params.thickness);
    }
};

}  // namespace

FloatGrid::Ptr mesh_distance_unsigned(const Mesh& mesh, const openvdb::math::Transform& transform, double band) {
    const auto out = distance(mesh, transform, band, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    out->setGridClass(openvdb::GRID_UNKNOWN);
    return out;
}

FloatGrid::Ptr mesh_distance(const Mesh& mesh, const openvdb::math::Transform& transform, double band, std::optional<double> thickness) {
    if (!thickness) {
        if (!topology_of(mesh).closed()) return mesh_distance_unsigned(mesh, transform, band);
        const auto out = distance(mesh, transform, band, 0);
        out->setGridClass(openvdb::GRID_LEVEL_SET);
        return out;
    }
    const double voxel = transform.voxelSize().x();
    const auto half = static_cast<float>(0.5 * *thickness), background = static_cast<float>(band * voxel);
    const auto around = mesh_distance_unsigned(mesh, transform, band + half / voxel);
    const auto tree = std::make_shared<openvdb::FloatTree>(around->tree(), background, openvdb::TopologyCopy());
    openvdb::tree::LeafManager<openvdb::FloatTree>(*tree).foreach ([&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
        const auto* const from = around->tree().probeConstLeaf(leaf.origin());
        for (auto voxels = leaf.beginValueOn(); voxels; ++voxels) {
            const float value = from->getValue(voxels.pos()) - half;
            voxels.setValue(std::clamp(value, -background, background));
            if (std::abs(value) >= background) voxels.setValueOff();
        }
    });
    openvdb::tools::pruneLevelSet(*tree);
    auto out = FloatGrid::create(tree);
    out->setTransform(transform.copy());
    out->setGridClass(openvdb::GRID_LEVEL_SET);
    out->setName("surface");
    return out;
}

NodeType sdf_from_mesh() {
    using Params = SdfFromMesh::Params;
    using Ports = SdfFromMesh::Ports;
    return Declare<SdfFromMesh>("sdf.from_mesh", "Distances to the faces of a mesh, in a narrow band: a level set if the mesh is closed.")
        .input("mesh", &Ports::mesh, "Any mesh. A closed one has an inside, where distances are below 0; another has none (see `thickness`).")
        .input("like", &Ports::like, "A grid whose voxels the result takes, instead of `voxel_size`; only its transform counts.")
        .param("voxel_size", &Params::voxel_size, Unit::world, at_least(1e-6), "Edge of a voxel; the centre of one is at the world's origin.")
        .param("band", &Params::band, Unit::voxels, between(2, 1000), "How far from the faces distances are known, on each side.")
        .param("thickness", &Params::thickness, Unit::world, at_least(1e-6),
               "Makes a shell of this thickness around the faces, which is closed whatever the mesh. Auto: none.")
        .output("surface", &Ports::surface, "Distances, world units, named `surface`.");
}

}  // namespace fluidcarve
