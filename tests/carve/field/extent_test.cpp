#include "carve/field/extent.h"

#include "carve/base/failure.h"
#include "carve/field/leaf_cell.h"
#include "tests/support/failure_of.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace fluidcarve;
using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using test::failure_of;

namespace {
constexpr int lowest = std::numeric_limits<int>::min(), highest = std::numeric_limits<int>::max();
const CoordBBox whole({lowest, 0, 0}, {highest, 0, 1});
}  // namespace

TEST_CASE("the extents of a box are right up to the ends of index space") {
    CHECK(extents_of(CoordBBox()) == std::array<std::int64_t, 3>{0, 0, 0});
    CHECK(extents_of(whole) == std::array<std::int64_t, 3>{std::int64_t{1} << 32, 1, 2});
    CHECK(voxels_in(CoordBBox()) == 0);
    CHECK(voxels_in(whole) == std::uint64_t{1} << 33);
    CHECK(voxels_in(CoordBBox(Coord(lowest), Coord(highest))) ==
          std::numeric_limits<std::uint64_t>::max());
    CHECK(span_text(whole) ==
          "[-2147483648, 0, 0] to [2147483647, 0, 1]: 4294967296 x 1 x 2 voxels");
    CHECK(padded(whole, 3) == CoordBBox({lowest, -3, -3}, {highest, 3, 4}));
}

TEST_CASE("a place is a voxel only within index space") {
    CHECK(voxel_at({1.4, -2.6, 1e9}) == Coord(1, -3, 1'000'000'000));
    for (const double far : {1.1e9, -1e300, std::nan(""), std::numeric_limits<double>::infinity()})
        CHECK(!voxel_at({0, far, 0}));
    CHECK(voxel_below({1.5, -1.5, -2}) == Coord(1, -2, -2));
    for (const double far : {1e10, -1e300, std::nan(""), std::numeric_limits<double>::infinity()})
        CHECK(std::abs(voxel_below({far, 0, 0}).x()) > 2'000'000'000);
}

TEST_CASE("a box in the world has voxels, or is refused") {
    const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
    CHECK(voxels_around(BBoxd(Vec3d(0, 0.25, 1), Vec3d(1, 1, 1.3)), *transform, "the lattice") ==
          CoordBBox({0, 0, 2}, {2, 2, 3}));
    CHECK(failure_of([&] {
              voxels_around(BBoxd(Vec3d(0), Vec3d(1, 2, 1e12)), *transform, "the lattice");
          }) ==
          "the lattice reaches from [0, 0, 0] to [2, 4, 2e+12], counted in voxels of 0.5 x 0.5 x "
          "0.5, the first at [0, 0, 0]; 1000000000 is the farthest: check "
          "the units of both, or resample the grid");
    CHECK_THROWS_AS(voxels_around(BBoxd(Vec3d(std::nan("")), Vec3d(1)), *transform, "the lattice"),
                    Failure);
}

TEST_CASE("a grid is refused where its voxels lie too far, and a walk where it would not end") {
    CHECK(failure_of([&] {
              require_near("density", CoordBBox(Coord(-farthest_voxel), Coord(farthest_voxel)));
          }) == "");
    CHECK(failure_of([&] { require_near("density", CoordBBox()); }) == "");
    CHECK(failure_of([&] { require_near("density", whole); }) ==
          "the active voxels of grid 'density' span [-2147483648, 0, 0] to [2147483647, 0, 1]: "
          "4294967296 x 1 x 2 voxels; voxel 1000000000 is the farthest: crop "
          "the grid");
    CHECK(failure_of([&] {
              require_walkable("the lattice", CoordBBox(Coord(0), Coord(9999, 9999, 9999)), 2);
          }) == "");
    CHECK(failure_of([&] { require_walkable("the lattice", whole, 0); }) == "");
    CHECK(failure_of([&] { require_walkable("the lattice", whole, 2); }) ==
          "the lattice spans [-2147483648, 0, 0] to [2147483647, 0, 1]: 4294967296 x 1 x 2 voxels, "
          "more than can be walked: make it smaller, or crop the grid");
}

TEST_CASE("the box of active voxels is OpenVDB's") {
    auto grid = openvdb::FloatGrid::create();
    CHECK(active_box(*grid).empty());
    grid->tree().setValueOff({900, 0, 0}, 1.0f);
    CHECK(active_box(*grid).empty());
    for (const Coord& at : {Coord(3, -5, 6), Coord(-20, 2, 7), Coord(4, 9, -1), Coord(100, 0, 0)}) {
        grid->tree().setValueOn(at, 1.0f);
        CHECK(active_box(*grid) == grid->evalActiveVoxelBoundingBox());
    }
    grid->tree().addTile(1, {0, 64, 0}, 1.0f, true);
    CHECK(active_box(*grid) == grid->evalActiveVoxelBoundingBox());
    grid->tree().addTile(2, {0, 0, -256}, 1.0f, true);
    CHECK(active_box(*grid) == grid->evalActiveVoxelBoundingBox());
}
