#include "carve/time/paced.h"

#include "carve/points/point_vectors.h"
#include "tests/support/point_lists.h"

#include <openvdb/openvdb.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

/// Time goes faster along x.
double rate(const Vec3d& world) { return 1 + world.x(); }

template <class GridT>
openvdb::GridBase::Ptr one_voxel(const std::string& name, const Coord& at,
                                 const typename GridT::ValueType& value) {
    const auto out = GridT::create();
    out->setName(name);
    out->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    out->tree().setValueOn(at, value);
    return out;
}

}  // namespace

TEST_CASE("velocities are multiplied by how fast time goes where they are, and nothing else is") {
    const Coord at(4, 1, 0);  // x = 2
    Volume volume;
    volume.grids.emplace_back(one_voxel<FloatGrid>("density", at, 7));
    volume.grids.emplace_back(one_voxel<VectorGrid>("velocity", at, openvdb::Vec3s(1, 2, 3)));
    volume.grids.emplace_back(one_voxel<openvdb::Vec3DGrid>("force", at, Vec3d(4, 5, 6)));
    for (const auto* const part : {"vel.x", "vel.y", "vel.z"})
        volume.grids.emplace_back(one_voxel<FloatGrid>(part, at, 2));
    const auto out = paced(volume, rate);
    const auto now = [&](const char* name) { return out.find(name); };
    CHECK(now("density") == volume.find("density"));
    CHECK(openvdb::gridConstPtrCast<VectorGrid>(now("velocity"))->tree().getValue(at) ==
          openvdb::Vec3s(3, 6, 9));
    CHECK(openvdb::gridConstPtrCast<openvdb::Vec3DGrid>(now("force"))->tree().getValue(at) ==
          Vec3d(12, 15, 18));
    CHECK(openvdb::gridConstPtrCast<FloatGrid>(now("vel.y"))->tree().getValue(at) == 6);
    CHECK(openvdb::gridConstPtrCast<VectorGrid>(volume.find("velocity"))->tree().getValue(at) ==
          openvdb::Vec3s(1, 2, 3));
}

TEST_CASE("so are the velocities of points, and points without any stay as they are") {
    auto table = ply_at({Vec3d(0), Vec3d(3, 0, 0)});
    Points bare;
    bare.ply = std::make_shared<PointTable>(table);
    CHECK(paced(bare, rate).ply == bare.ply);
    for (const auto& [name, value] : {std::pair("vx", 1.0F), {"vy", 2.0F}, {"vz", 0.0F}})
        table.columns.push_back(
            column(name, "float", NumberType::float32, std::vector<float>(2, value)));
    Points points;
    points.ply = std::make_shared<PointTable>(std::move(table));
    const auto out = paced(points, rate);
    const auto velocities = vectors_of(out, velocity_name(out));
    CHECK(velocities == std::vector<Vec3d>{{1, 2, 0}, {4, 8, 0}});
    CHECK(out.positions() == points.positions());
}

TEST_CASE("in a tile of one velocity each voxel has the rate of its place") {
    const auto grid = VectorGrid::create();
    grid->setName("velocity");
    grid->tree().addTile(1, Coord(0), openvdb::Vec3s(1, 0, 0), true);
    Volume volume;
    volume.grids.emplace_back(grid);
    const auto out = openvdb::gridConstPtrCast<VectorGrid>(paced(volume, rate).find("velocity"));
    for (const int x : {0, 3, 7})
        CHECK(out->tree().getValue(Coord(x, 1, 2)) == openvdb::Vec3s(1.0F + float(x), 0, 0));
}
