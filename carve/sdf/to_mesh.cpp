#include "carve/sdf/to_mesh.h"

#include <openvdb/tools/VolumeToMesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fluidcarve {

namespace {

/// Adds faces with reversed orientation: OpenVDB orients them inwards.
template <class Faces>
void add_turned(const Faces& faces, Mesh& out) {
    for (const auto& face : faces) {
        std::array<std::uint32_t, Faces::value_type::size> turned;
        for (std::size_t n = 0; n < turned.size(); ++n)
            turned[n] = face[static_cast<int>(turned.size() - 1 - n)];
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
    const bool rises =
        grid.getGridClass() == openvdb::GRID_LEVEL_SET || grid.background() > isovalue;
    const auto grid_class = openvdb::GridBase::gridClassToString(rises ? openvdb::GRID_LEVEL_SET
                                                                       : openvdb::GRID_FOG_VOLUME);
    meta.insertMeta(openvdb::GridBase::META_GRID_CLASS, openvdb::StringMetadata(grid_class));
    const auto classed = openvdb::gridConstPtrCast<FloatGrid>(
        static_cast<const openvdb::GridBase&>(grid).copyGridReplacingMetadata(meta));
    openvdb::tools::volumeToMesh(*classed, points, triangles, quads, isovalue, adaptivity, true);
    Mesh out;
    out.points.assign(points.begin(), points.end());
    add_turned(quads, out);
    add_turned(triangles, out);
    return out;
}

}  // namespace fluidcarve
