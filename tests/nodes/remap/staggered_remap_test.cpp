#include "carve/lattice/alignment.h"
#include "carve/lattice/lattice.h"
#include "carve/remap/grid.h"
#include "carve/stream/raw_grid.h"
#include "nodes/remap.h"
#include "tests/nodes/remap/remap_cases.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/warped.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

TEST_CASE("components of a staggered grid are carved at their faces") {
    // The lattice is shifted along the seam's normal by half a voxel: x faces fall on vertices,
    // centres between them.
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    const auto grid = VectorGrid::create();
    grid->setTransform(transform);
    grid->setGridClass(openvdb::GRID_STAGGERED);
    auto values = grid->getAccessor();
    for (auto at = CoordBBox(Coord(0), Coord(15)).begin(); at; ++at)
        values.setValueOn(*at, openvdb::Vec3s(float((*at).x()), float((*at).x()), 1.0f));
    const auto lattice = make_box(Vec3d(-0.5, 0, 0), {16, 16, 16}, 1.0, {0, 1, 2});
    const auto got = carved<VectorGrid>(
        grid, lattice,
        map_of_count(lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove, {6})));
    CHECK(got->tree().getValue(Coord(5, 4, 4)) ==
          openvdb::Vec3s(5, 5.5f, 1));  // its face is vertex 5; its centre lies in the seam's cell
    CHECK(got->tree().getValue(Coord(6, 4, 4)) == openvdb::Vec3s(7, 7, 1));
    CHECK(got->tree().getValue(Coord(4, 4, 4)) == openvdb::Vec3s(4, 4, 1));
}

TEST_CASE("whole numbers are read from the nearest voxel, never interpolated") {
    auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    transform->preRotate(0.2, openvdb::math::Z_AXIS);
    const auto grid = openvdb::Int32Grid::create();
    grid->setTransform(transform);
    auto values = grid->getAccessor();
    for (auto at = CoordBBox(Coord(-10), Coord(20)).begin(); at; ++at)
        values.setValueOn(*at, ((*at).x() + (*at).y()) % 2 ? 7 : -9);
    const auto lattice = make_box(Vec3d(0), {10, 10, 5}, 1.0, {0, 1, 2});
    const auto got = carved<openvdb::Int32Grid>(
        grid, lattice,
        map_of_count(lattice, straight_seams(lattice, Axis::v, Seams::Kind::insert, {4})));
    CHECK(got != grid);
    for (auto voxel = got->cbeginValueOn(); voxel; ++voxel) CHECK((*voxel == 7 || *voxel == -9));
}

TEST_CASE("what can't be carved is refused by name") {
    const auto lattice = make_box(Vec3d(0), {8, 8, 8}, 1.0, {0, 1, 2});
    const auto seams = straight_seams(lattice, Axis::u, Seams::Kind::remove, {3});
    const auto unknown = std::make_shared<RawGrid>("Tree_float_5_4_2", 0, 0);
    unknown->setName("fine");
    CHECK(failure_of([&] {
              carve_grid(unknown, lattice, map_of_count(lattice, seams), Interpolation::linear);
          }) ==
          "grid 'fine' is of type Tree_float_5_4_2, which can't be carved; name the grids to carve "
          "in `grids:` of the reader and connect those");

    const auto other = make_box(Vec3d(1, 0, 0), {8, 8, 8}, 1.0, {0, 1, 2});
    CHECK(failure_of([&] { map_of_count(other, seams); }) ==
          "the seams were found in another lattice: theirs is a box of 8 x 8 x 8 vertices from (0, "
          "0, 0) to (7, 7, 7), spacing 1, axes xyz (" +
              lattice.hash +
              "), this one a box of 8 x 8 x 8 vertices from (1, 0, 0) to (8, 7, 7), spacing 1, "
              "axes xyz (" +
              other.hash + ")");
    // Seams of another tool may state another hash: the description decides.
    auto old = seams;
    old.lattice_hash = "0123456789abcdef";
    CHECK_NOTHROW(map_of_count(lattice, old));
    CHECK(failure_of([&] {
              map_of_count(other, old);
          }).starts_with("the seams were found in another lattice"));

    const auto set = std::make_shared<Seams>(seams);
    CHECK(failure_of([&] {
              CarveMap(lattice, {set, set}, 1, {});
          }) ==
          "seam set 2 of 2 carves 8 x 8 x 8 vertices, but set 1 leaves 7 x 8 x 8; list the sets in "
          "the order in which they were found");
    CHECK(failure_of([&] { CarveMap(lattice, {set}, 2, {}); }) ==
          "the seams do not hold frame 2; they hold 1");
    CHECK(failure_of([&] { CarveMap(lattice, {set}, 1, 2); }) ==
          "count asks for 2 seams, but the seam set holds 1");
}

TEST_CASE("remap.grids shares the grids that do not change, and takes a count of either sign") {
    const auto lattice = std::make_shared<Lattice>(make_box(Vec3d(0), {8, 8, 8}, 1.0, {0, 1, 2}));
    const auto seams =
        std::make_shared<Seams>(straight_seams(*lattice, Axis::u, Seams::Kind::remove, {3, 2}));
    const auto volume = std::make_shared<Volume>();
    const auto grid = dense_grid(CoordBBox(Coord(0), Coord(7)),
                                 openvdb::math::Transform::createLinearTransform(1.0),
                                 [](const Coord& at) { return float(at.x() + 1); });
    volume->grids = {grid, FloatGrid::create()};
    const NodeBench::Inputs inputs{{"source", {Payload(volume)}},
                                   {"lattice", {Payload(lattice)}},
                                   {"seams", {Payload(seams)}}};

    for (const auto* count : {"{count: 1}", "{count: -1}"}) {
        const auto got = NodeBench(remap_grids(), count).run(inputs).at("volume").as<Volume>();
        CHECK(got->grids[0] != grid);
        CHECK(got->grids[1] == volume->grids[1]);
        CHECK(openvdb::GridBase::grid<FloatGrid>(got->grids[0])->tree().getValue(Coord(2, 0, 0)) ==
              3.0f);
        CHECK(openvdb::GridBase::grid<FloatGrid>(got->grids[0])->tree().getValue(Coord(3, 0, 0)) ==
              5.0f);
    }
    CHECK(NodeBench(remap_grids(), "{count: 0}").run(inputs).at("volume").as<Volume>() == volume);
    CHECK(failure_of([&] { NodeBench(remap_grids(), "{count: 3}").run(inputs); }) ==
          "count asks for 3 seams, but the seam set holds 2");
}
