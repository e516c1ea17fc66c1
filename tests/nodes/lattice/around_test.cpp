#include "carve/lattice/block_places.h"
#include "carve/lattice/overlap.h"
#include "carve/lattice/polar.h"
#include "carve/rig/circle.h"
#include "formats/geometry_file/wireframe.h"
#include "nodes/lattice.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/built_lattices.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec2d;
using openvdb::Vec3d;

namespace {

/// Open and closed, with tight bends.
std::vector<Lattice> lattices_around() {
    return {around(through(helix_points()), 0.9, 0.11),
            around(through(saddle_points(), true), 0.8, 0.09)};
}

Vec3d random_place_around(std::mt19937& random, const Lattice& lattice) {
    return {between(random, 0, lattice.shape[0] - 1), between(random, 0, lattice.shape[1]),
            between(random, 0, lattice.shape[2] - (lattice.closed ? 0 : 1))};
}

/// The distance of lattice coordinates, the short way around.
double distance_around(const Lattice& lattice, const Vec3d& a, const Vec3d& b) {
    auto off = a - b;
    off.y() -= lattice.shape[1] * std::round(off.y() / lattice.shape[1]);
    if (lattice.closed) off.z() -= lattice.shape[2] * std::round(off.z() / lattice.shape[2]);
    return off.length();
}

}  // namespace

TEST_CASE("around a straight rig, u is the distance from it and v the angle around it") {
    const auto lattice = around(through({{1, 2, 0}, {1, 2, 10}}, false, {0, 1, 0}), 4, 0.5);
    CHECK(lattice.shape == std::array{9, 50, 21});
    CHECK_FALSE(lattice.is_box());
    const Mapping mapping(lattice);
    std::mt19937 random(1);
    for (int n = 0; n < 5000; ++n) {
        const double radius = between(random, 0.01, 3.99), turn = between(random, 0, 1),
                     height = between(random, 0, 10);
        // v begins at u = v0 x w: the world's x. It goes from there to `up`.
        const Vec3d at(1 + radius * std::cos(2 * M_PI * turn),
                       2 + radius * std::sin(2 * M_PI * turn), height);
        const auto place = mapping.locate(at);
        REQUIRE(place);
        CHECK(distance_around(lattice, *place, {radius / 0.5, 50 * turn, height / 0.5}) <
              3 * snap_width);
        CHECK((mapping.position({radius / 0.5, 50 * turn, height / 0.5}) - at).length() < 1e-9);
    }
    CHECK_FALSE(mapping.locate({5.01, 2, 5}));
    // On the rig all v are one place.
    CHECK(mapping.locate({1, 2, 5}) == Vec3d(0, 0, 10));
    for (const double v : {0.0, 12.3, 49.9})
        CHECK((lattice.position({0, v, 10}) - Vec3d(1, 2, 5)).length() < 1e-12);
    CHECK((lattice.position({3, -1, 7.5}) - lattice.position({3, 49, 7.5})).length() < 1e-12);
}

TEST_CASE(
    "folded cells around a rig are those with a corner on the wrong side of the neighbouring "
    "plane") {
    std::size_t folded = 0;
    for (const auto& whole : lattices_around())
        for (const int further : {0, 6, 40}) {
            const int extent = whole.shape[0] + further;
            const auto good = [&](int i, int j, int k) {
                const auto &low = whole.planes[static_cast<std::size_t>(k)],
                           &high = whole.planes[static_cast<std::size_t>((k + 1) % whole.shape[2])];
                const auto across = i * Polar(whole.shape[1]).direction(j) * whole.spacing;
                const auto on = [&](const auto& plane) {
                    return plane.origin + across.x() * plane.u + across.y() * plane.v;
                };
                return low.w.dot(on(high) - low.origin) > 0 &&
                       high.w.dot(high.origin - on(low)) > 0;
            };
            std::size_t expected = 0;
            for (int k = 0; k + 1 < whole.shape[2] + (whole.closed ? 1 : 0); ++k)
                for (int j = 0; j < whole.shape[1]; ++j)
                    for (int i = 0; i + 1 < extent; ++i)
                        expected += !(good(i, j, k) && good(i + 1, j, k) && good(i, j + 1, k) &&
                                      good(i + 1, j + 1, k));
            CHECK(count_folds(whole, extent, whole.shape[1]).cells == expected);
            folded += expected;
        }
    CHECK(folded > 1000);
}

TEST_CASE("a position around a rig comes back from its lattice coordinates, also beside the rig") {
    std::mt19937 random(2);
    for (const auto& lattice : lattices_around()) {
        const Mapping mapping(lattice);
        REQUIRE(count_folds(lattice, lattice.shape[0], lattice.shape[1]).cells == 0);
        for (int n = 0; n < 20000; ++n) {
            auto place = random_place_around(random, lattice);
            if (n % 4 == 0) place.x() *= 1e-3;
            const auto world = mapping.position(place);
            REQUIRE((lattice.position(place) - world).length() < 1e-12);
            const auto found = mapping.locate(world);
            INFO("place " << place);
            REQUIRE(found);
            REQUIRE((mapping.position(*found) - world).length() < 1e-4 * lattice.spacing);
            if (place.x() > 0.5) REQUIRE(distance_around(lattice, *found, place) < 1e-4);
        }
    }
}

TEST_CASE(
    "a block's voxels are found around a rig where they are found one by one, and move away from "
    "it") {
    std::mt19937 random(3);
    int compared = 0, on_rig = 0;
    for (const auto& lattice : lattices_around()) {
        const Mapping mapping(lattice, {lattice.shape[0] + 2, lattice.shape[1], lattice.shape[2]});
        const auto transform =
            openvdb::math::Transform::createLinearTransform(lattice.spacing * 0.9);
        transform->preRotate(0.4, openvdb::math::Y_AXIS);
        BlockPlaces places(mapping, *transform);
        for (int m = 0; m < 60; ++m) {
            auto middle = random_place_around(random, lattice);
            if (m % 3 == 0) middle.x() = 0;
            const auto voxel = Coord::round(transform->worldToIndex(mapping.position(middle)));
            const Coord block(voxel.x() & ~7, voxel.y() & ~7, voxel.z() & ~7);
            const auto range = places.move_to(block);
            const auto reach = places.reach(Vec3d(-2, 0, 0), Vec3d(3, 0, 0));
            for (int row = 0; row < 64; ++row) {
                const auto first = block.offsetBy(row >> 3, row & 7, 0);
                BlockPlaces::Row found;
                places.locate(first, Vec3d(0), found);
                for (int z = 0; z < 8; ++z) {
                    const auto p = first.offsetBy(0, 0, z).asVec3d();
                    const auto world = transform->indexToWorld(p);
                    const auto single = mapping.locate(world);
                    REQUIRE(single.has_value() == ((found.inside >> z & 1) != 0));
                    if (!single) continue;
                    const auto& place = found.places[static_cast<std::size_t>(z)];
                    if (place.at.x() > 0.01)
                        REQUIRE(distance_around(lattice, place.at, *single) < 1e-7);
                    const auto source = place.at + Vec3d(3, 0, 0);
                    const auto moved = places.moved(p, place, Vec3d(3, 0, 0));
                    REQUIRE((transform->indexToWorld(moved) -
                             (world + mapping.position(source) - mapping.position(place.at)))
                                .length() < 1e-9);
                    REQUIRE(reach.isInside(Coord::floor(moved)));
                    const auto wrapped = [&](int axis, int size) {
                        return place.at[axis] < range.min()[axis] - snap_width
                                   ? place.at[axis] + size
                                   : place.at[axis];
                    };
                    for (const auto& [value, axis] :
                         {std::pair{place.at.x(), 0}, std::pair{wrapped(1, lattice.shape[1]), 1},
                          std::pair{lattice.closed ? wrapped(2, lattice.shape[2]) : place.at.z(),
                                    2}}) {
                        REQUIRE(value >= range.min()[axis] - snap_width);
                        REQUIRE(value <= range.max()[axis] + snap_width);
                    }
                    ++compared;
                    on_rig += place.at.x() < 1;
                }
            }
        }
    }
    CHECK(compared > 10000);
    CHECK(on_rig > 100);
}

TEST_CASE("the world box of a range around a rig holds its points") {
    std::mt19937 random(4);
    for (const auto& lattice : lattices_around()) {
        const Mapping mapping(lattice);
        for (int n = 0; n < 20; ++n) {
            const auto a = random_place_around(random, lattice),
                       b = random_place_around(random, lattice);
            const BBoxd range(openvdb::math::minComponent(a, b), openvdb::math::maxComponent(a, b));
            auto box = mapping.world_box(range);
            box.min() -= Vec3d(1e-12);
            box.max() += Vec3d(1e-12);
            for (int m = 0; m < 300; ++m)
                REQUIRE(box.isInside(
                    mapping.position({between(random, range.min().x(), range.max().x()),
                                      between(random, range.min().y(), range.max().y()),
                                      between(random, range.min().z(), range.max().z())})));
        }
    }
}

TEST_CASE(
    "voxels around a rig lie in one cell each, on the rig too, and where turns of a helix meet "
    "they are counted") {
    const auto cubes = openvdb::math::Transform::createLinearTransform(0.1);
    const auto apart = around(through(helix_points()), 0.9, 0.1),
               meeting = around(through(helix_points(0.15)), 0.9, 0.1);
    CHECK(count_overlap(Mapping(apart), *cubes).voxels == 0);
    CHECK(count_overlap(Mapping(meeting), *cubes).voxels > 100);
}

TEST_CASE(
    "lattice.around says what it built, and a bend sharper than its radius is smoothed or told") {
    const auto straight = through({{0, 0, 0}, {0, 0, 5}}, false, {0, 1, 0});
    const Run run("{spacing: 0.5, radius: 3}", {straight}, {}, lattice_around());
    CHECK(run.lattices[0]->around);
    CHECK(run.lattices[0]->description ==
          "lattice of 7 x 38 x 11 vertices around an open path of 2 points from (0, 0, 0) to (0, "
          "0, 5), radius 3, spacing 0.5");
    CHECK(run.heard.reported["lattices"]["around"] == true);
    CHECK(run.heard.warnings.empty());

    const auto corner = through({{0, 0, 0}, {5, 0, 0}, {5, 5, 0}});
    const Run sharp("{spacing: 0.5, radius: 2, smooth: none}", {corner}, {}, lattice_around());
    REQUIRE(sharp.heard.warnings.size() == 1);
    CHECK(sharp.heard.warnings[0].find("cells are folded") != std::string::npos);
    CHECK(sharp.heard.warnings[0].ends_with("reduce 'radius', or smooth the rig more"));
    const Run smoothed("{spacing: 0.5, radius: 2}", {corner}, {}, lattice_around());
    CHECK(smoothed.heard.reported["lattices"]["folded_cells"] == 0);

    const Run wide("{spacing: 0.25, radius: 2.5}",
                   {circle_rig(Vec3d(0), Vec3d(0, 0, 1), {2, 2}, 0)}, {}, lattice_around());
    REQUIRE(wide.heard.warnings.size() == 1);
    CHECK(wide.heard.warnings[0].ends_with(
        "past the centre of a circle of radius 2 around (0, 0, 0), and no smoothing repairs that: "
        "keep 'radius' within the "
        "radius"));

    const auto faults = [](const std::string& yaml) {
        return NodeBench(lattice_around(), yaml, {{"rig", 1}}).faults();
    };
    CHECK(faults("{spacing: 0.5, radius: 0.4}") ==
          "radius: 'radius' 0.4 is less than the spacing, 0.5: nothing can be carved\n");
    CHECK(faults("{spacing: 0.001, radius: 20}") ==
          "radius: 'radius' 20 takes more than 65534 vertices for a turn at a spacing of 0.001; "
          "10.43 is the most\n");
    CHECK(faults("{spacing: 0.5, radius: 3}").empty());
}

TEST_CASE("the hash of a lattice tells whether it goes around its rig") {
    auto lattice = around(through({{0, 0, 0}, {0, 0, 5}}, false, {0, 1, 0}), 3, 0.5);
    const auto hash = lattice.hash;
    lattice.around = false;
    CHECK(lattice_hash(lattice) != hash);
}

TEST_CASE("the wireframe of a lattice around a rig closes around it") {
    const Scratch scratch;
    const auto lattice = around(through({{0, 0, 0}, {0, 0, 1}}, false, {0, 1, 0}), 1, 1);
    REQUIRE(lattice.shape == std::array{2, 6, 2});
    write_wireframe(scratch / "around.obj", lattice, {1, 1, 1});
    const auto text = Scratch::read(scratch / "around.obj");
    // Vertices stand in rows of two: the sixth at the outer rim of the first plane is joined with
    // the first.
    CHECK(text.find("\nl 12 2\n") != std::string::npos);
}
