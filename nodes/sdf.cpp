#include "nodes/sdf.h"

#include "carve/field/stencil.h"
#include "carve/mesh/made_once.h"
#include "carve/mesh/mesh.h"
#include "carve/points/points.h"
#include "carve/sdf/from_mesh.h"
#include "carve/sdf/from_points.h"
#include "carve/sdf/to_mesh.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "nodes/params/voxels_of.h"

namespace fluidcarve {

namespace {

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
        check_voxels(params.voxel_size, check);
    }

    void run(const Params& params, Ports& io, Context& context) const {
        const auto transform = voxels_of(io.like, params.voxel_size);
        if (io.like) require_cubes(*io.like->grid);
        io.surface = made_(io.mesh, *transform, [&] {
            return mesh_distance(*io.mesh, *transform, params.band, params.thickness);
        });
        if (io.surface->getGridClass() != openvdb::GRID_LEVEL_SET)
            context.warn(
                "the mesh is not closed, so that it has no inside: the distances have no sign; "
                "state a `thickness` for a shell around its faces");
    }

private:
    MadeOnce<FloatGrid> made_;
};

}  // namespace

NodeType sdf_from_mesh() {
    using Params = SdfFromMesh::Params;
    using Ports = SdfFromMesh::Ports;
    return Declare<SdfFromMesh>("sdf.from_mesh",
                                "Distances to the faces of a mesh, in a narrow band: a level set "
                                "if the mesh is closed.")
        .input("mesh", &Ports::mesh,
               "Any mesh. Distances are negative inside a closed mesh; any other mesh has no "
               "inside (see `thickness`).")
        .input("like", &Ports::like,
               "The result takes the voxels of this grid, instead of `voxel_size`. Only its "
               "transform counts.")
        .param("voxel_size", &Params::voxel_size, Unit::world, at_least(least_voxel),
               "Edge of a voxel. A voxel centre is at the world's origin.")
        .param("band", &Params::band, Unit::voxels, between(2, 1000),
               "Half width of the narrow band: distances are known this far from the faces, on "
               "each side.")
        .param(
            "thickness", &Params::thickness, Unit::world, at_least(1e-6),
            "Makes a closed shell of this thickness around the faces of any mesh. Auto: no shell.")
        .output("surface", &Ports::surface,
                "The distances, world units, as a grid named `surface`.")
        .kept();
}

namespace {

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

    static void check(const Params& params, NodeCheck& check) {
        check_voxels(params.voxel_size, check);
    }

    static void run(const Params& params, Ports& io, Context&) {
        if (io.like) require_cubes(*io.like->grid);
        const auto transform = voxels_of(io.like, params.voxel_size);
        io.surface = sdf_of_points(*io.points, *transform,
                                   {params.radius, params.smoothing, params.half_width});
    }
};

}  // namespace

NodeType sdf_from_points() {
    return Declare<FromPoints>(
               "sdf.from_points",
               "The surface of particles: the distance to balls around them, as a level set.")
        .input("points", &FromPoints::Ports::points,
               "The particles. A frame without particles has no surface.")
        .input("like", &FromPoints::Ports::like,
               "The surface takes the voxels of this grid, such as the particles' velocity. Only "
               "its transform counts.")
        .param("voxel_size", &FromPoints::Params::voxel_size, Unit::world,
               between(least_voxel, 1e9),
               "Edge of a voxel, instead of `like`. A voxel centre is at the world's origin.")
        .param("radius", &FromPoints::Params::radius, Unit::voxels, between(0.5, 100),
               "Radius of the balls. If particles are about half a voxel apart, as in most "
               "liquids, 1 to 2 gives a closed surface.")
        .param("smoothing", &FromPoints::Params::smoothing, Unit::none, between(0, 100),
               "Number of times that the surface is averaged over 3 x 3 x 3 voxels.")
        .param("half_width", &FromPoints::Params::half_width, Unit::voxels, between(2, 100),
               "Half width of the narrow band: distances are known this far from the surface, on "
               "each side.")
        .output("surface", &FromPoints::Ports::surface,
                "The distance to the surface, world units, negative inside.")
        .kept();
}

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
        require_stencil_fits(*io.surface, sizeof(float), context.limits().memory);
        io.mesh =
            std::make_shared<Mesh>(surface_mesh(*io.surface, params.isovalue, params.adaptivity));
    }
};

}  // namespace

NodeType sdf_to_mesh() {
    using Params = SdfToMesh::Params;
    return Declare<SdfToMesh>("sdf.to_mesh",
                              "Makes a mesh of the surface on which a grid has a given value: that "
                              "of a level set, or of a density.")
        .input("surface", &SdfToMesh::Ports::surface,
               "A level set; or a density, with an `isovalue`.")
        .param("isovalue", &Params::isovalue, Unit::none, any_number(),
               "The value on the surface, in the grid's unit. 0 for level sets.")
        .param("adaptivity", &Params::adaptivity, Unit::none, between(0, 1),
               "0: one quad per voxel. Up to 1: fewer and larger faces, also triangles, where the "
               "surface is flat.")
        .output("mesh", &SdfToMesh::Ports::mesh,
                "The surface. Faces are oriented outwards, without UVs.")
        .kept();
}

}  // namespace fluidcarve
