#include "carve/solver/costs/content.h"
#include "carve/rig/circle.h"
#include "carve/solver/costs/frame_energy.h"
#include "tests/support/built_lattices.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <cstdint>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

FloatGrid::Ptr filled_cube(int size) {
    const auto out = FloatGrid::create();
    out->denseFill(CoordBBox(Coord(0), Coord(size - 1)), 1.0f, true);
    return out;
}

Lattice box_at(const Vec3d& first, const std::array<int, 3>& shape, double spacing) {
    return make_box(first, shape, spacing, {0, 1, 2});
}

}  // namespace

TEST_CASE("voxels lie in a box if its vertices are as near as half a spacing or half a voxel") {
    const auto grid = filled_cube(8);
    const auto half = content_in(*grid, box({4, 8, 8}));
    CHECK(half.voxels == 512);
    CHECK(half.inside == 256);
    CHECK(half.share() == 0.5);
    // One vertex thick and between two layers of voxels; then nearer to one, in a lattice finer
    // than the voxels.
    CHECK(content_in(*grid, box_at({0, 0, 3.5}, {8, 8, 1}, 1)).inside == 128);
    CHECK(content_in(*grid, box_at({0, 0, 3.3}, {29, 29, 1}, 0.25)).inside == 64);
    CHECK(content_in(*grid, box_at({20, 0, 0}, {8, 8, 8}, 1)).inside == 0);
    CHECK(content_in(*FloatGrid::create(), box({4, 8, 8})).voxels == 0);
}

TEST_CASE("voxels of tiles count as many as they are, and many voxels are counted by some") {
    const auto tile = FloatGrid::create();
    tile->tree().addTile(2, Coord(0), 1.0f, true);
    const auto counted = content_in(*tile, box({64, 128, 128}));
    CHECK(counted.voxels == std::uint64_t{1} << 21);
    CHECK(counted.inside == 1 << 20);
    const auto many = content_in(*filled_cube(100), box({50, 100, 100}));
    CHECK(many.voxels == 1000000);
    CHECK(many.inside == Approx(5e5).epsilon(0.03));
}

TEST_CASE("voxels lie in a ring where its cells are, not in its middle nor beyond its rims") {
    const auto ring = build_lattice(circle_rig({0, 0, 0}, {0, 0, 1}, {2, 2}, 0), spec(0.2)).lattice;
    const auto grid = FloatGrid::create();
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
    for (const int x : {0, 20, 25, 27}) grid->tree().setValue(Coord(x, 0, 0), 1);
    const auto content = content_in(*grid, ring);
    CHECK(content.voxels == 4);
    CHECK(content.inside == 2);
}

TEST_CASE(
    "a vertex that sees energy is content, though the voxels that are looked at miss the lattice") {
    const auto tile = FloatGrid::create();
    tile->tree().addTile(2, Coord(0), 1.0f, true);
    const auto within = [&](const Vec3d& first) {
        return sample_frame({*tile}, std::make_shared<Lattice>(box_at(first, {4, 4, 4}, 1)),
                            Axis::u, Measure::vertex)
            .content.inside;
    };
    CHECK(within(Vec3d(0)) == 1);
    CHECK(within(Vec3d(200)) == 0);
}

TEST_CASE(
    "a lattice too fine for the memory is refused before room is made, with a spacing that fits") {
    const auto fault = [](double voxel) {
        const auto grid = FloatGrid::create();
        grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
        return failure_of([&] {
            require_frame_fits({*grid}, box_at(Vec3d(0), {4001, 4001, 3}, 0.01), 80000000);
        });
    };
    CHECK(fault(0.5) ==
          "at a 'spacing' of 0.01 the lattice has 4001 x 4001 x 3 vertices, which take 96.0 MB in "
          "each frame, but --memory allows 80.0 MB; the voxels of "
          "`energy` are 0.5 wide: a 'spacing' of 0.5 fits");
    CHECK(fault(0.001) ==
          "at a 'spacing' of 0.01 the lattice has 4001 x 4001 x 3 vertices, which take 96.0 MB in "
          "each frame, but --memory allows 80.0 MB; the voxels of "
          "`energy` are 0.001 wide: a 'spacing' of 0.0125 fits");
    const auto grid = FloatGrid::create();
    CHECK_NOTHROW(require_frame_fits({*grid}, box({100, 100, 100}), 0));
    // A field takes as much again.
    CHECK_NOTHROW(require_frame_fits({*grid}, box_at(Vec3d(0), {4001, 4001, 2}, 0.01), 80000000));
    CHECK(
        failure_of([&] {
            require_frame_fits({*grid, &*grid}, box_at(Vec3d(0), {4001, 4001, 2}, 0.01), 80000000);
        }).find("which take 128 MB") != std::string::npos);
}
