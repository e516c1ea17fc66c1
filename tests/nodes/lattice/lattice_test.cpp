#include "nodes/lattice.h"
#include "carve/lattice/alignment.h"
#include "carve/lattice/mapping.h"
#include "carve/volume/volume.h"
#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

Payload grid_of(const CoordBBox& active, const openvdb::math::Transform::Ptr& transform) {
    const auto grid = FloatGrid::create();
    grid->setName("density");
    grid->setTransform(transform);
    if (!active.empty()) grid->fill(active, 1.0f);
    return Payload(std::make_shared<AnyGrid>(AnyGrid{grid}));
}

openvdb::math::Transform::Ptr voxels_of(double size, const Vec3d& place = Vec3d(0)) {
    const auto out = openvdb::math::Transform::createLinearTransform(size);
    out->postTranslate(place);
    return out;
}

Lattice fitted(const std::vector<Payload>& grids, const std::string& yaml = "{}") {
    static const std::vector<int> frames{7, 8, 9};
    Context::Host host;
    NodeBench bench(lattice_box(), yaml, {{"fit", 1}});
    for (std::size_t t = 0; t < grids.size(); ++t)
        bench.add({{"fit", {grids[t]}}}, Context(host, frames).at(t));
    return *bench.gathered({}).at("lattice").as<Lattice>();
}

std::string faults(const std::string& yaml) { return NodeBench(lattice_box(), yaml).faults(); }

}  // namespace

TEST_CASE("a box puts its vertices at equal distances along the chosen world axes") {
    const auto lattice = make_box(Vec3d(1, 2, 3), {5, 4, 3}, 0.5, {2, 0, 1});
    CHECK(lattice.is_box());
    CHECK(lattice.position(Vec3d(0, 0, 0)) == Vec3d(1, 2, 3));
    CHECK(lattice.position(Vec3d(4, 0, 0)) == Vec3d(1, 2, 5));
    CHECK(lattice.position(Vec3d(0, 3, 0)) == Vec3d(2.5, 2, 3));
    CHECK(lattice.position(Vec3d(0, 0, 2)) == Vec3d(1, 3, 3));
    CHECK(lattice.position(Vec3d(0.5, -1, 2.5)) == Vec3d(0.5, 3.25, 3.25));
    CHECK(lattice.description ==
          "box of 5 x 4 x 3 vertices from (1, 2, 3) to (2.5, 3, 5), spacing 0.5, axes zxy");
}

TEST_CASE("a lattice of bent planes is no box, and between its planes it is straight") {
    auto lattice = make_box(Vec3d(0), {3, 3, 3}, 1.0, {0, 1, 2});
    lattice.planes[1].origin.x() += 0.5;
    CHECK(!lattice.is_box());
    CHECK(lattice.position(Vec3d(1, 1, 0.5)) == Vec3d(1.25, 1, 0.5));
    CHECK(Mapping(lattice).position(Vec3d(1, 1, 0.5)) == Vec3d(1.25, 1, 0.5));
}

TEST_CASE(
    "the hash of a lattice depends on everything but its description, and not on the sign of "
    "zero") {
    const auto lattice = make_box(Vec3d(0), {3, 4, 5}, 1.0, {0, 1, 2});
    CHECK(lattice.hash.starts_with("xxh3-64:"));
    CHECK(lattice.hash.size() == 8 + 16);
    CHECK(lattice.hash == make_box(Vec3d(-0.0), {3, 4, 5}, 1.0, {0, 1, 2}).hash);
    for (const auto& other : {make_box(Vec3d(1e-12, 0, 0), {3, 4, 5}, 1.0, {0, 1, 2}),
                              make_box(Vec3d(0), {4, 3, 5}, 1.0, {0, 1, 2}),
                              make_box(Vec3d(0), {3, 4, 5}, 1.0000000001, {0, 1, 2}),
                              make_box(Vec3d(0), {3, 4, 5}, 1.0, {1, 0, 2})})
        CHECK(lattice.hash != other.hash);
}

TEST_CASE("a mapping and its inverse agree, snap to vertices, and end a hair beyond the rims") {
    const auto lattice = make_box(Vec3d(0.3, -7, 11), {9, 8, 7}, 0.1, {1, 2, 0});
    const Mapping mapping(lattice);
    const Vec3d between(3.25, 6.5, 0.125);
    CHECK((*mapping.locate(mapping.position(between)) - between).length() < 1e-12);
    for (int i = 0; i < 9; ++i)
        CHECK(mapping.locate(mapping.position(Vec3d(i, 3, 4)) + Vec3d(5e-7)) == Vec3d(i, 3, 4));
    CHECK(mapping.locate(mapping.position(Vec3d(8.00009, -0.00009, 3))) == Vec3d(8, 0, 3));
    CHECK(!mapping.locate(mapping.position(Vec3d(8.0002, 0, 3))));
    CHECK(!mapping.locate(mapping.position(Vec3d(0, -0.0002, 3))));
    CHECK(Mapping(lattice, {11, 8, 7}).locate(mapping.position(Vec3d(9.5, 0, 3))));
}

TEST_CASE(
    "vertices are found to be voxels through mirrored, scaled and turned transforms, but not "
    "beside them") {
    const auto lattice = make_box(Vec3d(1, 1, 1), {5, 4, 1}, 0.5, {0, 1, 2});
    const auto same = align(lattice, *voxels_of(0.5));
    REQUIRE(same);
    CHECK(same->one_to_one());
    CHECK(same->voxel(3, 2, 0) == Coord(5, 4, 2));
    CHECK(same->vertex(Coord(5, 4, 2)) == Coord(3, 2, 0));

    const auto finer = align(lattice, *voxels_of(0.25));
    REQUIRE(finer);
    CHECK(!finer->one_to_one());
    CHECK(finer->voxel(3, 2, 0) == Coord(10, 8, 4));

    CHECK(!align(lattice, *voxels_of(1.0)));
    CHECK(!align(lattice, *voxels_of(0.5, Vec3d(0.25, 0, 0))));
    CHECK(align(lattice, *voxels_of(0.5, Vec3d(4e-6, 0, 0))));
    const auto turned = voxels_of(0.5);
    turned->preRotate(M_PI / 2, openvdb::math::Z_AXIS);
    const auto quarter = align(lattice, *turned);
    REQUIRE(quarter);
    CHECK(quarter->one_to_one());
    CHECK(quarter->vertex(quarter->voxel(3, 2, 0)) == Coord(3, 2, 0));
    CHECK((turned->indexToWorld(quarter->voxel(3, 2, 0)) - lattice.position(Vec3d(3, 2, 0)))
              .length() < 1e-9);
}

TEST_CASE("lattice.box stands between min and max") {
    const auto made =
        NodeBench(lattice_box(), "{min: [0, 0, 0], max: [6.75, 4, 5.5], spacing: 0.25, axes: yxz}")
            .gathered({})
            .at("lattice")
            .as<Lattice>();
    CHECK(made->shape == std::array{17, 28, 23});
    CHECK(made->position(Vec3d(16, 27, 22)) == Vec3d(6.75, 4, 5.5));
    CHECK(NodeBench(lattice_box(), "{min: [0, 0, 0], max: [2.0004, 2, 0], spacing: 1}")
              .gathered({})
              .at("lattice")
              .as<Lattice>()
              ->shape == std::array{3, 3, 1});
}

TEST_CASE("lattice.box fits the voxels that are active in any frame") {
    const auto transform = voxels_of(0.5, Vec3d(0.1, 0.2, 0.3));
    const auto lattice = fitted({grid_of(CoordBBox(Coord(-2, 0, 1), Coord(3, 4, 5)), transform),
                                 grid_of(CoordBBox(), voxels_of(3)),
                                 grid_of(CoordBBox(Coord(0, 0, 0), Coord(4, 1, 1)), transform)},
                                "{axes: zyx}");
    CHECK(lattice.shape == std::array{6, 5, 7});
    CHECK(lattice.spacing == 0.5);
    CHECK(lattice.position(Vec3d(0)) == transform->indexToWorld(Coord(-2, 0, 0)));
    CHECK((lattice.position(Vec3d(5, 4, 6)) - transform->indexToWorld(Coord(4, 4, 5))).length() <
          1e-12);
}

TEST_CASE("lattice.box refuses to fit what has no one box") {
    const CoordBBox active(Coord(0), Coord(3));
    CHECK(failure_of([&] {
              fitted({grid_of(active, voxels_of(0.5)), grid_of(active, voxels_of(0.25))});
          }) ==
          "grid 'density' has voxels of 0.5 x 0.5 x 0.5, the first at [0, 0, 0] in frame 7, but "
          "voxels of 0.25 x 0.25 x 0.25, the first at [0, 0, 0] in frame 8: "
          "no lattice fits both; bake the sequence with a fixed domain, or make its voxels alike "
          "with grid.resample");
    CHECK(failure_of([&] { fitted({grid_of(CoordBBox(), voxels_of(0.5))}); }) ==
          "the grid to fit has no active voxels in any frame; state 'min', 'max' and 'spacing' "
          "instead");
    const auto frustum =
        openvdb::math::Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 3.0, 0.1);
    CHECK(failure_of([&] { fitted({grid_of(active, frustum)}); }) ==
          "grid 'density' has voxels of varying shape (NonlinearFrustumMap) in frame 7; a box fits "
          "voxels of one shape, as grid.resample makes them: or state "
          "'min', 'max' and 'spacing' instead");
}

TEST_CASE(
    "lattice.box stands on turned, mirrored, sheared and oblong voxels, along the axes nearest to "
    "the world's") {
    const CoordBBox active(Coord(-1, 0, 2), Coord(3, 5, 4));
    const auto check = [&](const openvdb::math::Transform::Ptr& transform,
                           const std::array<int, 3>& shape) {
        const auto lattice = fitted({grid_of(active, transform)});
        CHECK(lattice.shape == shape);
        const auto alignment = align(lattice, *transform);
        REQUIRE(alignment);
        CHECK(alignment->one_to_one());
        // The corners are those of the active voxels, and u, v and w run along x, y and z.
        CoordBBox box(alignment->voxel(0, 0, 0), alignment->voxel(0, 0, 0));
        box.expand(alignment->voxel(shape[0] - 1, shape[1] - 1, shape[2] - 1));
        CHECK(box == active);
        for (int n = 0; n < 3; ++n) {
            Vec3d next(0);
            next[n] = 1;
            CHECK((lattice.position(next) - lattice.position(Vec3d(0)))[n] > 0);
        }
        const Mapping mapping(lattice);
        const Vec3d at(1.25, 2.5, 0.75);
        CHECK((*mapping.locate(lattice.position(at)) - at).length() < 1e-9);
        CHECK(!mapping.locate(lattice.position(at - Vec3d(1.5, 0, 0))));
    };
    const auto turned = voxels_of(0.5), quarter = voxels_of(0.5), mirrored = voxels_of(0.5),
               oblong = voxels_of(0.5), sheared = voxels_of(0.5);
    turned->preRotate(0.1, openvdb::math::Y_AXIS);
    check(turned, {5, 6, 3});
    quarter->postRotate(M_PI / 2, openvdb::math::Z_AXIS);
    check(quarter, {6, 5, 3});
    mirrored->postScale({-1, 1, -1});
    check(mirrored, {5, 6, 3});
    oblong->postScale({1, 1.01, 3});
    check(oblong, {5, 6, 3});
    sheared->postShear(0.4, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
    check(sheared, {5, 6, 3});
}

TEST_CASE("lattice.box goes with a container that moves") {
    const auto at = [](double x) { return voxels_of(0.5, Vec3d(x, 0, 0)); };
    const CoordBBox active(Coord(0, 0, 0), Coord(3, 3, 3));
    // Two voxels further, and a third of a voxel before.
    const auto lattice =
        fitted({grid_of(active, at(0)), grid_of(active, at(1)), grid_of(active, at(-0.15))});
    CHECK(lattice.shape == std::array{7, 4, 4});
    CHECK(lattice.position(Vec3d(0)) == Vec3d(-0.5, 0, 0));
    CHECK_THAT(failure_of([&] {
                   fitted({grid_of(active, at(0)), grid_of(active, at(1e9))});
               }),
               Catch::EndsWith("in frame 8, too far from the others for one lattice"));
}

TEST_CASE("lattice.box says what is wrong with its extent before a run") {
    CHECK(faults("{min: [0, 0, 0], max: [1, 1, 1], spacing: 0.3}") ==
          "max: the extent 1 in x is no whole multiple of the spacing 0.3; the nearest 'max' that "
          "fits is 0.9\n"
          "max: the extent 1 in y is no whole multiple of the spacing 0.3; the nearest 'max' that "
          "fits is 0.9\n"
          "max: the extent 1 in z is no whole multiple of the spacing 0.3; the nearest 'max' that "
          "fits is 0.9\n");
    CHECK(faults("{min: [0, 2, 0], max: [1, 1, 1], spacing: 0.5}") ==
          "max: 'max' is below 'min' in y: 1 < 2\n");
    CHECK(faults("{min: [0, 0, 0], max: [1, 1, 1], spacing: 0}") ==
          "spacing: 'spacing' must be above 0\n");
    CHECK(faults("{min: [0, 0, 0], max: [1e6, 1, 1], spacing: 1}") ==
          "max: the extent 1000000 in x is 1000000 times the spacing 1; 65533 is the most\n");
    CHECK(faults("{min: [0, 0, 0], spacing: 1}") ==
          "max: needs either 'fit', or all of 'min', 'max' and 'spacing'\n");
    CHECK(faults("{}") == "min: needs either 'fit', or all of 'min', 'max' and 'spacing'\n");
    CHECK(NodeBench(lattice_box(), "{spacing: 1}", {{"fit", 1}}).faults() ==
          "spacing: 'spacing' and 'fit' exclude each other: a fitted box takes its place and "
          "spacing from the grid\n");
}

TEST_CASE("a spacing that was typed with few digits does not move the vertices off the voxels") {
    const double voxel = 1.0 / 3;
    const auto box = [&](const std::string& max) {
        return *NodeBench(lattice_box(),
                          "{min: [0, 0, 0], max: [" + max + ", 5, 2], spacing: 0.333333}")
                    .gathered({})
                    .at("lattice")
                    .as<Lattice>();
    };
    const auto exact = box("9");
    CHECK(exact.shape == std::array{28, 16, 7});
    CHECK((exact.position(Vec3d(27, 0, 0)) - Vec3d(9, 0, 0)).length() < 1e-12);
    CHECK(align(exact, *voxels_of(voxel)).has_value());
    CHECK(align(box("9.33333"), *voxels_of(voxel)).has_value());
    CHECK(!align(box("9"), *voxels_of(voxel, Vec3d(0.01, 0, 0))).has_value());
}

TEST_CASE("a fitted box is refused where its entries would not fit 16 bits") {
    const auto far = FloatGrid::create();
    far->setName("density");
    far->tree().setValue({0, 0, 0}, 1);
    far->tree().setValue({100000, 0, 0}, 1);
    CHECK_THROWS_WITH(
        fitted({Payload(std::make_shared<AnyGrid>(AnyGrid{far}))}),
        "the active voxels of grid 'density' span [0, 0, 0] to [100000, 0, 0]: 100001 x 1 x 1 "
        "voxels; 65534 along an axis is the most: crop the grid, or state "
        "'min', 'max' and 'spacing' of a part");
}

TEST_CASE("a fitted box is refused where its extents would not fit 32 bits") {
    constexpr int lowest = std::numeric_limits<int>::min(),
                  highest = std::numeric_limits<int>::max();
    const auto whole = FloatGrid::create();
    whole->setName("density");
    whole->tree().setValue({lowest, 0, 0}, 1);
    whole->tree().setValue({highest, 0, 0}, 1);
    try {
        fitted({Payload(std::make_shared<AnyGrid>(AnyGrid{whole}))});
        FAIL("not refused");
    } catch (const Failure& failure) {
        CHECK(failure.kind == Failure::Kind::input);
        CHECK(std::string(failure.what()) ==
              "the active voxels of grid 'density' span [-2147483648, 0, 0] to [2147483647, 0, 0]: "
              "4294967296 x 1 x 1 voxels; 65534 along an axis is the most: "
              "crop the grid, or state 'min', 'max' and 'spacing' of a part");
    }
}

TEST_CASE("a lattice beyond all voxels of a grid is aligned with none") {
    CHECK(!align(make_box(Vec3d(0), {2, 2, 2}, 1e10, {0, 1, 2}), *voxels_of(1)).has_value());
    CHECK(!align(make_box(Vec3d(1e300, 0, 0), {2, 2, 2}, 1, {0, 1, 2}), *voxels_of(1)).has_value());
}
