#include "nodes/sdf/to_mesh.h"

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
    static void run(const Params& params, Ports& io, Context&) {
        io.mesh = std::make_shared<Mesh>(surface_mesh(*io.surface, params.isovalue, params.adaptivity));
    }
};

/// OpenVDB turns faces to the inside.
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
    // OpenVDB takes what lies below the value for the inside in grids of this class alone, and else what lies above.
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
    return Declare<SdfToMesh>("sdf.to_mesh", "The surface of a level set, or of any grid where it has a value, as a mesh.")
        .input("surface", &SdfToMesh::Ports::surface, "A level set; or a density, with an `isovalue`.")
        .param("isovalue", &Params::isovalue, Unit::none, any_number(), "Where the surface lies, in the grid's unit: 0 in level sets.")
        .param("adaptivity", &Params::adaptivity, Unit::none, between(0, 1),
               "0: a quad per voxel, evenly; up to 1: fewer and larger faces, triangles among them, where the surface is flat.")
        .output("mesh", &SdfToMesh::Ports::mesh, "Faces turned outwards, without UVs.")
        .kept();
}

}  // namespace fluidcarve
