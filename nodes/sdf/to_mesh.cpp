#include "nodes/sdf/to_mesh.h"

#include "nodes/field/stencil.h"

#include <openvdb/tools/VolumeToMesh.h>

#include <array>

namespace fluidcarve {
namespace {

struct SdfToMesh {
    struct Params {
        double isovalue = 0;
        double adaptivity = 0;
    };
    struct Ports {
        Ref<FloatGrid> surface;
        Ref<Mesh> mesh;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.surface, sizeof(float), context.memory_budget());
        io.mesh = std::make_shared<Mesh>(surface_mesh(*io.surface, params.isovalue, params.adaptivity));
    }
};

/// Adds faces with reversed orientation: OpenVDB orients them inwards.
template <class Faces>
void add_turned(const Faces& faces, Mesh& out) {
    for (const auto& face : faces) {
        std::array<std::uint32_t, Faces::value_type::size> turned;
        for (std::size_t n = 0; n < turned.size(); ++n) turned[n] = face[static_cast<int>(turned.size() - 1 - n)];
        out.add_face(turned);
    }
}

}  // namespace

Mesh surface_mesh(const FloatGrid& grid, double isovalue, double adaptivity) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    // For OpenVDB the inside is below the value in level sets, and above it in all other classes.
    openvdb::MetaMap meta(grid);
    const bool rises = grid.getGridClass() == openvdb::GRID_LEVEL_SET || grid.background() > isovalue;
    const auto grid_class = openvdb::GridBase::gridClassToString(rises ? openvdb::GRID_LEVEL_SET : openvdb::GRID_FOG_VOLUME);
    meta.insertMeta(openvdb::GridBase::META_GRID_CLASS, openvdb::StringMetadata(grid_class));
    const auto classed = openvdb::gridConstPtrCast<FloatGrid>(static_cast<const openvdb::GridBase&>(grid).copyGridReplacingMetadata(meta));
    openvdb::tools::volumeToMesh(*classed, points, triangles, quads, isovalue, adaptivity, true);
    Mesh out;
    out.points.assign(points.begin(), points.end());
    add_turned(quads, out);
    add_turned(triangles, out);
    return out;
}

NodeType sdf_to_mesh() {
    using Params = SdfToMesh::Params;
    return Declare<SdfToMesh>("sdf.to_mesh", "Makes a mesh of the surface on which a grid has a given value: that of a level set, or of a density.")
        .input("surface", &SdfToMesh::Ports::surface, "A level set; or a density, with an `isovalue`.")
        .param("isovalue", &Params::isovalue, Unit::none, any_number(), "The value on the surface, in the grid's unit. 0 for level sets.")
        .param("adaptivity", &Params::adaptivity, Unit::none, between(0, 1),
               "0: one quad per voxel. Up to 1: fewer and larger faces, also triangles, where the surface is flat.")
        .output("mesh", &SdfToMesh::Ports::mesh, "The surface. Faces are oriented outwards, without UVs.")
        .kept();
}

}  // namespace fluidcarve
