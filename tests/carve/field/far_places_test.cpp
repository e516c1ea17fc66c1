#include "carve/base/values.h"
#include "carve/field/extent.h"
#include "carve/grid/crop.h"
#include "carve/grid/resample.h"
#include "carve/mask/below_surface.h"
#include "carve/remap/finish/level_set.h"
#include "carve/remap/voxels/slow_part.h"
#include "carve/time/motion.h"
#include "carve/time/time_surface.h"

#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

// Values from files and parameters that no whole number, no memory and no patience holds.

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;

namespace {

constexpr std::uint64_t budget = std::uint64_t{1} << 30;

FloatGrid::Ptr cube(int size, float value) {
    const auto out = FloatGrid::create();
    out->setName("density");
    out->denseFill(CoordBBox(Coord(0), Coord(size - 1)), value, true);
    return out;
}

/// Two voxels at the ends of a diagonal.
FloatGrid::Ptr far_apart(const Coord& end) {
    const auto out = FloatGrid::create();
    out->setName("density");
    out->tree().setValueOn(Coord(0), 1);
    out->tree().setValueOn(end, 1);
    return out;
}

Volume volume_of(const FloatGrid::Ptr& grid) {
    Volume out;
    out.grids.emplace_back(grid);
    return out;
}

}  // namespace

TEST_CASE("a far place becomes one that whole numbers hold, and no number becomes 0") {
    const auto nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(near_place({1e30, -1e30, nan}) == Vec3d(farthest_voxel, -farthest_voxel, 0));
    CHECK(near_place({1.5, -2, 0}) == Vec3d(1.5, -2, 0));
}

TEST_CASE("a percentage of many vertices is no more than a count may be") {
    CHECK(Count{1e6, true}.of(300'000'000) == 1'000'000'000);
    CHECK(Count{-1e6, true}.of(300'000'000) == -1'000'000'000);
}

TEST_CASE("a surface of moments takes few cubes, also of 2^64 voxels") {
    const Coord end((1 << 24) - 1, (1 << 23) - 1, (1 << 23) - 1);
    const auto grid = far_apart(end), other = far_apart(end);
    TimeSurface surface(*grid, 4, 2, CoordBBox(Coord(0), end));
    for (int n = 0; n < 4; ++n) surface.add(*grid, *other);
    surface.finish();
}

TEST_CASE("a crop to a box beyond index space leaves all") {
    const auto all = cropped(volume_of(cube(4, 1)), openvdb::BBoxd(Vec3d(-1e12), Vec3d(1e12)));
    CHECK(openvdb::gridConstPtrCast<FloatGrid>(all.grids[0].grid())->activeVoxelCount() == 64);
}

TEST_CASE("voxels that new ones can't number are refused") {
    CHECK_THROWS_WITH(resampled(volume_of(far_apart(Coord(500'000'000, 0, 0))),
                                *openvdb::math::Transform::createLinearTransform(0.01), budget),
                      Catch::Contains("grid 'density'"));
}

TEST_CASE("a grid without active voxels is resampled, too") {
    const auto empty = FloatGrid::create();
    empty->tree().touchLeaf(Coord(0));
    const auto out =
        resampled(volume_of(empty), *openvdb::math::Transform::createLinearTransform(0.5), budget);
    CHECK(out.grids[0].header().activeVoxelCount() == 0);
}

TEST_CASE("nothing lies deeper below a surface than space goes") {
    const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(5, Vec3d(0), 1);
    for (const double depth : {1e30, 4294967296.0})
        CHECK(below_surface_mask({ball}, Vec3d(0, 0, 1), depth)->activeVoxelCount() == 0);
}

TEST_CASE("a band of distances that is too wide is not made anew") {
    const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(5, Vec3d(0), 1);
    CHECK(can_renormalize(*ball));
    for (const float band : {1e6f, 3e38f}) {
        ball->tree().root().setBackground(band, false);
        CHECK_FALSE(can_renormalize(*ball));
    }
}

TEST_CASE("content too far apart for the slow part of a fade is refused, and a wide fade ends") {
    CHECK_THROWS_WITH(SlowPart(*far_apart(Coord(100'000)), 2),
                      Catch::StartsWith("grid 'density' is too wide for `join: fade`"));
    const SlowPart wide(*cube(16, 1), 1e5);
    CHECK(std::isfinite(wide.at(Vec3d(8), 0)));
}

TEST_CASE("wild velocities move content a stretch that can be followed") {
    const auto shown = cube(12, 1);
    for (const float speed : {1.0f, 3e38f}) {
        const auto velocity = VectorGrid::create();
        velocity->denseFill(CoordBBox(Coord(-4), Coord(15)), Vec3s(speed, -speed, 0), true);
        for (const double scale : {1e5, 1e38}) {
            const auto motion = motion_between({shown, velocity}, {shown, velocity}, scale, budget);
            for (auto value = motion->cbeginValueOn(); value; ++value)
                REQUIRE((*value).length() < 1000);
        }
    }
}
