#include "carve/lattice/content_reach.h"
#include "carve/rig/circle.h"
#include "tests/support/built_lattices.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

constexpr double voxel = 0.5;

/// Smoke of density 1 in a box of voxels, above a haze that does not count as content.
FloatGrid::Ptr smoke(const CoordBBox& box, bool tiles = true) {
    auto out = FloatGrid::create();
    out->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    auto haze = box;
    haze.expand(20);
    out->sparseFill(haze, 0.01f);
    out->sparseFill(box, 1.0f);
    if (!tiles) out->tree().voxelizeActiveTiles();
    return out;
}

const Rig along_x = through({{0, 0, 0}, {20, 0, 0}});

/// What lattice.build makes of rigs and contents, a frame each.
struct Built {
    Heard heard;
    Ref<Lattice> lattice;
    Built(const std::string& yaml, const std::vector<FloatGrid::Ptr>& contents) {
        NodeBench bench(lattice_build(), yaml, {{"rig", 1}, {"content", 1}});
        REQUIRE(bench.faults() == "");
        std::vector<int> frames;
        for (std::size_t t = 0; t < contents.size(); ++t) frames.push_back(static_cast<int>(t));
        const Payload rig(std::make_shared<Rig>(along_x));
        for (std::size_t t = 0; t < contents.size(); ++t)
            bench.add({{"rig", {rig}}, {"content", {Payload(FloatGrid::ConstPtr(contents[t]))}}},
                      Context(heard, frames).at(t));
        const Context all(heard, frames);
        bench.finish(all);
        lattice = bench.run({{"rig", {rig}}}, all).at("lattice").as<Lattice>();
    }
};

}  // namespace

TEST_CASE("content around a straight rig is as wide as its voxels, and reaches beyond the ends") {
    // x from -3 to 25, y from -2 to 4, z from -1 to 1.
    const CoordBBox box(Coord(-6, -4, -2), Coord(50, 8, 2));
    for (const bool tiles : {true, false}) {
        const auto reach = content_reach(*smoke(box, tiles), along_x);
        REQUIRE(reach);
        CHECK(reach->u == Approx(6 + voxel));
        CHECK(reach->v == Approx(2 + voxel));
        CHECK(reach->before == Approx(3));
        CHECK(reach->after == Approx(5));
    }
    // Large enough for tiles of 8 voxels and more.
    const CoordBBox thick(Coord(0, -48, -32), Coord(40, 47, 31));
    const auto reach = content_reach(*smoke(thick), along_x);
    REQUIRE(reach);
    CHECK(reach->u == Approx(96 * voxel));
    CHECK(reach->v == Approx(64 * voxel));
    CHECK(reach->before == 0);
    CHECK(reach->after == Approx(0).margin(1e-9));
}

TEST_CASE("content in tiles of any size is measured at once") {
    auto grid = FloatGrid::create();
    grid->tree().addTile(3, Coord(0), 1.0f, true);
    const auto side = grid->evalActiveVoxelBoundingBox().dim().x();
    REQUIRE(side == 4096);
    const auto reach = content_reach(*grid, through({{100, 2048, 2048}, {3996, 2048, 2048}}));
    REQUIRE(reach);
    CHECK(reach->u == side);
    CHECK(reach->before == 100);
    CHECK(reach->after == 99);
}

TEST_CASE("content around a closed rig is measured across it, and has no ends") {
    const auto ring = circle_rig({0, 0, 0}, {0, 0, 1}, {6, 6}, 0);
    auto torus = FloatGrid::create(3 * 0.2);
    torus->setTransform(openvdb::math::Transform::createLinearTransform(0.2));
    torus->setGridClass(openvdb::GRID_LEVEL_SET);
    for (auto at = CoordBBox(Coord(-45, -45, -12), Coord(45, 45, 12)).begin(); at; ++at) {
        const auto p = torus->indexToWorld(*at);
        const double distance = std::hypot(std::hypot(p.x(), p.y()) - 6, p.z()) - 1.5;
        if (std::abs(distance) < 0.6) torus->tree().setValue(*at, static_cast<float>(distance));
    }
    const auto reach = content_reach(*torus, ring);
    REQUIRE(reach);
    CHECK(reach->u == Approx(3).margin(0.2));
    CHECK(reach->v == Approx(3).margin(0.2));
    CHECK(reach->before == 0);
    CHECK(reach->after == 0);
}

TEST_CASE("nothing is measured of content that lies beyond the ends, or that there is none of") {
    CHECK(!content_reach(*smoke(CoordBBox(Coord(60, -4, -2), Coord(70, 4, 2)), false), along_x));
    CHECK(!content_reach(*FloatGrid::create(), along_x));
}

TEST_CASE("lattice.build counts extents in shares of the content, and holds all of its length") {
    // 9 and 11 voxels wide, 5 high: on the mean 5 by 2.5.
    const auto thin = smoke(CoordBBox(Coord(-6, -4, -2), Coord(44, 4, 2))),
               wide = smoke(CoordBBox(Coord(0, -5, -2), Coord(50, 5, 2))),
               none = FloatGrid::create();
    const Built built("{extent_u: [-150%, 100%], extent_v: [-20%, 100%]}", {thin, wide, none});
    CHECK(built.lattice->spacing == voxel);
    // From -7.5 to 5, and from -0.5 to 2.5.
    CHECK(built.lattice->shape[0] == 26);
    CHECK(built.lattice->shape[1] == 7);
    const auto first = built.lattice->position(Vec3d(0, 0, 0)),
               last = built.lattice->position(Vec3d(0, 0, built.lattice->shape[2] - 1));
    CHECK(first.x() == Approx(-3 - 7.5));
    CHECK(last.x() == Approx(25 + 7.5).margin(voxel));
    CHECK(first.z() == Approx(-0.5));
    CHECK(built.heard.warnings.empty());

    const Built stated("{spacing: 1, extent_u: [-2, 2], extent_v: [-200%, 200%]}", {thin});
    CHECK(stated.lattice->spacing == 1);
    CHECK(stated.lattice->shape[0] == 5);
    CHECK(stated.lattice->shape[1] == 11);
}

TEST_CASE("lattice.build says what it lacks for shares, and where content shows nothing") {
    const auto faults = [](const std::string& yaml, std::size_t content) {
        std::map<std::string, std::size_t> connected{{"rig", 1}};
        if (content > 0) connected["content"] = content;
        return NodeBench(lattice_build(), yaml, connected).faults();
    };
    CHECK(faults("{extent_u: [-100%, 100%], extent_v: [0, 1]}", 1) == "");
    CHECK(faults("{extent_u: [-100%, 100%], extent_v: [0, 1]}", 0) ==
          "spacing: 'spacing' takes the voxel size of 'content', and that is not connected; "
          "connect it, or state the spacing\n"
          "extent_u: 'extent_u' counts the width of 'content', and that is not connected; connect "
          "it, or state world units\n");
    CHECK(faults("{extent_u: [100%, 100%], extent_v: [0, 1]}", 1) ==
          "extent_u: 'extent_u' is [100%, 100%], which is empty; for a single vertex, as for "
          "images, state less than one spacing\n");
    CHECK(faults("{extent_u: [0, 100%], extent_v: [2%, 1%]}", 1) ==
          "extent_u must be [low, high], world units or shares such as [-150%, 150%], not [0, "
          "100%]\n"
          "extent_v has its low end 2% above its high end 1%\n");
    CHECK(failure_of([] {
              Built("{extent_u: [-100%, 100%], extent_v: [0, 1]}", {FloatGrid::create()});
          }) ==
          "'content' shows nothing beside the rig in any frame: connect what the rig runs "
          "through, or move the rig with rig.transform");
    CHECK(failure_of([] {
              Built("{spacing: 0.0001, extent_u: [-100%, 100%], extent_v: [0, 1]}",
                    {smoke(CoordBBox(Coord(0, -4, -2), Coord(40, 4, 2)))});
          }) == "'extent_u' holds 90001 vertices at a spacing of 0.0001; 65534 is the most");
}
