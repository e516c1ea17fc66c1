#include "tools/compare/grids.h"

#include "carve/volume/volume.h"
#include "tools/compare/picture.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

const FilePair files{"a.vdb", "b.vdb"};

PartDifference compared(const openvdb::GridBase& a, const openvdb::GridBase& b,
                        const Tolerance& tolerance = {}) {
    return compare_grids("density", a, b, files, tolerance);
}

}  // namespace

TEST_CASE("grids are compared at all voxels that are active in either") {
    FloatGrid a, b;
    a.tree().setValue({0, 0, 0}, 1);
    a.tree().setValue({1, 0, 0}, 2);
    b.tree().setValue({0, 0, 0}, 1.5f);
    b.tree().setValue({9, 0, 0}, 3);
    const auto found = compared(a, b);
    CHECK(found.name == "density");
    CHECK(found.faults.empty());
    CHECK(found.compared == 3);
    CHECK(found.over == 3);
    CHECK(found.only_a == 1);
    CHECK(found.only_b == 1);
    CHECK(found.not_finite == 0);
    CHECK(found.mean() == Approx(5.5 / 3));
    CHECK(found.rms() == Approx(std::sqrt(13.25 / 3)));
    CHECK(found.peak == 3);
    REQUIRE(found.worst);
    CHECK(found.worst->index == std::vector<std::int64_t>{9, 0, 0});
    CHECK(found.worst->a == std::vector<double>{0});
    CHECK(found.worst->b == std::vector<double>{3});
    CHECK(compared(a, a).same());

    CHECK(compared(a, b, {1, 0, 0.4}).over == 2);
    CHECK(compared(a, b, {1, 0, 0.4}).warned == 3);
    CHECK(compared(a, b, {0, 0.5}).over == 2);
    CHECK(compared(a, b, {3, 0}).over == 0);
}

TEST_CASE("a voxel that is active in one grid alone differs, unless a tolerance allows it") {
    FloatGrid a, b;
    a.tree().setValue({4, 5, 6}, 0);
    CHECK(compared(a, b).over == 1);
    CHECK(compared(a, b).peak == 0);
    CHECK(compared(a, b).worst->index == std::vector<std::int64_t>{4, 5, 6});
    CHECK(compared(a, b, {1e-6, 0}).over == 0);
    CHECK_FALSE(compared(a, b, {1e-6, 0}).same());
}

TEST_CASE("tiles count as their voxels, and stay tiles") {
    FloatGrid a, b;
    const CoordBBox box(Coord(0), Coord(127));
    constexpr std::uint64_t voxels = 128 * 128 * 128;
    a.fill(box, 1);
    b.fill(box, 1.5f);
    const auto tiles = compared(a, b);
    CHECK(tiles.compared == voxels);
    CHECK(tiles.over == voxels);
    CHECK(tiles.mean() == 0.5);
    CHECK(a.tree().leafCount() == 0);

    b.fill(box, 1);
    b.tree().setValue({5, 5, 5}, 4);
    const auto voxel = compared(a, b);
    CHECK(voxel.compared == voxels);
    CHECK(voxel.over == 1);
    CHECK(voxel.peak == 3);
    CHECK(voxel.worst->index == std::vector<std::int64_t>{5, 5, 5});
    CHECK(a.tree().leafCount() == 0);
}

TEST_CASE(
    "vectors differ by the length of their difference, numbers that are not finite by infinity") {
    VectorGrid a, b;
    a.tree().setValue({0, 0, 0}, {3, 4, 7});
    b.tree().setValue({0, 0, 0}, {0, 0, 7});
    CHECK(compared(a, b).peak == 5);
    CHECK(compared(a, b).worst->a == std::vector<double>{3, 4, 7});

    constexpr auto nan = std::numeric_limits<float>::quiet_NaN();
    FloatGrid c, d;
    c.tree().setValue({0, 0, 0}, nan);
    d.tree().setValue({0, 0, 0}, nan);
    CHECK(compared(c, d).same());
    d.tree().setValue({0, 0, 0}, 1);
    const auto found = compared(c, d, {100, 0});
    CHECK(found.not_finite == 1);
    CHECK(found.over == 1);
    CHECK(std::isinf(found.peak));
    CHECK(found.mean() == 0);
}

TEST_CASE("grids of another type, transform, class or background are told as such") {
    FloatGrid a(0), b(1);
    b.setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    b.setGridClass(openvdb::GRID_LEVEL_SET);
    CHECK(compared(a, b).faults == std::vector<std::string>{
                                       "background: 0 in A, 1 in B",
                                       "transform: voxels of 1 x 1 x 1, the first at [0, 0, 0] in "
                                       "A; voxels of 0.5 x 0.5 x 0.5, the first at [0, 0, 0] in B",
                                       "class: unknown in A, level set in B",
                                   });
    const openvdb::DoubleGrid c;
    CHECK(compared(a, c).faults == std::vector<std::string>{"type: float in A, double in B"});
}

TEST_CASE("positions are compared one by one, if there are as many") {
    const auto moved =
        compare_positions("mesh", "vertices", {{0, 0, 0}, {1, 2, 3}}, {{0, 0, 0}, {1, 2, 1}}, {});
    CHECK(moved.compared == 2);
    CHECK(moved.over == 1);
    CHECK(moved.peak == 2);
    CHECK(moved.worst->index == std::vector<std::int64_t>{1});
    CHECK(*moved.worst->world == std::array<double, 3>{1, 2, 3});
    const auto more =
        compare_positions("mesh", "vertices", {{0, 0, 0}}, {{0, 0, 0}, {1, 2, 1}}, {});
    CHECK(more.faults == std::vector<std::string>{"vertices: 1 in A, 2 in B"});
    CHECK(more.compared == 0);
}

TEST_CASE(
    "the picture shows A, B and their difference side by side, in colours that can be compared") {
    const auto a = FloatGrid::create(), b = FloatGrid::create();
    a->denseFill(CoordBBox(Coord(0), Coord(7, 7, 0)), 1, true);
    b->denseFill(CoordBBox(Coord(0), Coord(7, 7, 0)), 1, true);
    b->tree().setValue({5, 2, 0}, 2);
    const auto picture = draw_difference({a, b, files, *compared(*a, *b).worst, "density"});
    // 8 x 8 voxels of 32 pixels; columns of 256 pixels, 14 apart, from (20, 126) on.
    CHECK(picture.width() == 836);
    CHECK(picture.height() == 438);
    const auto at = [&](int column, int x, int y) {
        return picture.at(20 + column * 270 + x * 32 + 16, 126 + (7 - y) * 32 + 16);
    };
    CHECK(at(0, 5, 2) == heat(0.5));
    CHECK(at(1, 5, 2) == heat(1));
    CHECK(at(1, 1, 1) == heat(0.5));
    CHECK(at(2, 5, 2) == diverging(1));
    CHECK(at(2, 1, 1) == diverging(0));
}
