#include "nodes/preview/difference.h"
#include "nodes/preview/slice.h"
#include "tests/support/sheets.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

TEST_CASE("a maximum projection takes the greatest active value along its axis") {
    const auto grid = named("density");
    auto values = grid->getAccessor();
    for (int x = -9; x <= 9; ++x)
        for (int y = -3; y <= 12; ++y)
            for (int z = -20; z <= 20; ++z)
                values.setValueOn(Coord(x, y, z), static_cast<float>(100 * x + 10 * y + z));
    values.setValueOff(Coord(9, 12, 20), 1e6f);
    const CoordBBox box(Coord(-9, -3, -20), Coord(9, 12, 20));

    const auto along_x = maximum_projection(*grid, View::x, box);
    CHECK(along_x.cell == 1);
    CHECK(along_x.cells.size(0) == 16);
    CHECK(along_x.cells.size(1) == 41);
    CHECK(along_x.at(-3, -20) == 900 - 30 - 20);
    CHECK(along_x.at(12, 20) == 800 + 120 + 20);
    const auto along_y = maximum_projection(*grid, View::y, box);
    CHECK(along_y.at(-9, 20) == -900 + 120 + 20);
    CHECK(along_y.at(4, -7) == 400 + 120 - 7);
    const auto along_z = maximum_projection(*grid, View::z, box);
    CHECK(along_z.at(-9, 12) == -900 + 120 + 20);
    CHECK(along_z.at(0, 0) == 20);

    const auto part =
        maximum_projection(*grid, View::z, CoordBBox(Coord(-2, 0, -5), Coord(2, 1, 3)));
    CHECK(part.cells.size(0) == 5);
    CHECK(part.at(2, 1) == 200 + 10 + 3);
}

TEST_CASE("what is not active is not seen, NaN neither") {
    const auto grid = named("density");
    auto values = grid->getAccessor();
    values.setValueOn(Coord(0, 0, 0), -2.0f);
    values.setValueOn(Coord(1, 0, 0), std::numeric_limits<float>::quiet_NaN());
    values.setValueOn(Coord(1, 1, 0), 3.0f);
    values.setValueOn(Coord(1, 2, 0), std::numeric_limits<float>::quiet_NaN());
    const auto seen = maximum_projection(*grid, View::y, CoordBBox(Coord(0), Coord(2)));
    CHECK(seen.at(0, 0) == -2.0f);
    CHECK(seen.at(1, 0) == 3.0f);
    CHECK(std::isnan(seen.at(2, 0)));
    CHECK(std::isnan(seen.at(0, 1)));
}

TEST_CASE("tiles are seen without being made into voxels") {
    const auto grid = named("density");
    grid->sparseFill(CoordBBox(Coord(-128), Coord(127)), 2.0f, true);
    grid->tree().setValueOn(Coord(5, 60, 5), 7.0f);
    const auto leaves = grid->tree().leafCount();
    const auto seen =
        maximum_projection(*grid, View::z, CoordBBox(Coord(-130, 50, -130), Coord(10, 70, 0)));
    CHECK(std::isnan(seen.at(-129, 55)));
    CHECK(seen.at(-128, 50) == 2.0f);
    CHECK(seen.at(10, 70) == 2.0f);
    CHECK(seen.at(5, 60) == 2.0f);
    CHECK(maximum_projection(*grid, View::z, CoordBBox(Coord(-130, 50, 0), Coord(10, 70, 5)))
              .at(5, 60) == 7.0f);
    CHECK(grid->tree().leafCount() == leaves);
}

TEST_CASE("of vectors the length is projected") {
    const auto grid = VectorGrid::create();
    grid->tree().setValueOn(Coord(0, 0, 0), {0, -3, 4});
    grid->tree().setValueOn(Coord(0, 1, 0), {1, 1, 1});
    CHECK(maximum_projection(*grid, View::y, CoordBBox(Coord(0), Coord(1))).at(0, 0) == 5.0f);
}

TEST_CASE("a large box is seen through larger cells, aligned in the whole index space") {
    const auto grid = named("density");
    grid->tree().setValueOn(Coord(-65, 0, -1), 1.0f);
    grid->tree().setValueOn(Coord(63, 0, 30), 2.0f);
    grid->tree().setValueOn(Coord(62, 5, 31), 3.0f);
    const CoordBBox box(Coord(-65, 0, -1), Coord(63, 5, 31));
    const auto seen = maximum_projection(*grid, View::y, box, 64);
    REQUIRE(seen.cell == 4);
    CHECK(seen.cells.first == std::array{-17, -1});
    CHECK(seen.cells.last == std::array{15, 7});
    CHECK(seen.at(-17, -1) == 1.0f);
    CHECK(seen.at(15, 7) == 3.0f);
    CHECK(std::isnan(seen.at(0, 0)));

    const auto same = fitted(maximum_projection(*grid, View::y, box), 4, seen.cells);
    for (std::size_t n = 0; n < seen.values.size(); ++n)
        CHECK((same.values[n] == seen.values[n] ||
               (std::isnan(same.values[n]) && std::isnan(seen.values[n]))));
}

TEST_CASE("colours grow lighter with the value, evenly enough to read in grey") {
    double last = -1;
    for (int n = 0; n <= 100; ++n) {
        const auto colour = heat(n / 100.0);
        const double light = 0.2126 * colour.red + 0.7152 * colour.green + 0.0722 * colour.blue;
        CHECK(light >= last);
        last = light;
    }
    CHECK(heat(-1) == heat(0));
    CHECK(heat(2) == heat(1));
    CHECK_FALSE(heat(0) == heat(1));
}

TEST_CASE("opposite differences are equally light, and lighter the larger") {
    const auto light = [](const Colour& colour) {
        return 0.2126 * colour.red + 0.7152 * colour.green + 0.0722 * colour.blue;
    };
    for (int n = 1; n <= 20; ++n) {
        const double size = n / 20.0;
        CHECK(light(diverging(size)) > light(diverging(size - 0.05)));
        CHECK(light(diverging(-size)) > light(diverging(0.05 - size)));
        CHECK(light(diverging(size)) == Approx(light(diverging(-size))).margin(14));
        CHECK(diverging(size).red > diverging(size).blue);
        CHECK(diverging(-size).blue > diverging(-size).red);
    }
    CHECK(diverging(-2) == diverging(-1));
    CHECK(diverging(2) == diverging(1));
}

TEST_CASE(
    "a difference is after minus before, and along a line of sight the largest with its sign") {
    const auto before = cube(Coord(0), 4, 1.0f);
    const auto after = cube(Coord(0), 4, 1.0f);
    after->tree().setValueOn(Coord(1, 0, 1), 1.5f);
    after->tree().setValueOn(Coord(1, 3, 1), 0.25f);
    after->tree().setValueOn(Coord(2, 1, 2), 3.0f);
    after->tree().setValueOn(Coord(3, 1, 3), std::numeric_limits<float>::quiet_NaN());
    const CoordBBox box(Coord(0), Coord(5));
    const auto seen = largest_difference(*before, *after, View::y, box);
    CHECK(seen.at(0, 0) == 0.0f);
    CHECK(seen.at(1, 1) == -0.75f);
    CHECK(seen.at(2, 2) == 2.0f);
    CHECK(seen.at(3, 3) == 0.0f);
    CHECK(std::isnan(seen.at(4, 0)));
    CHECK(largest_difference(*before, *after, View::y, slice_of(box, View::y, 0)).at(1, 1) == 0.5f);

    const auto old = VectorGrid::create();
    old->tree().setValueOn(Coord(0), {3, 4, 0});
    CHECK(largest_difference(*old, *VectorGrid::create(), View::z, CoordBBox(Coord(0), Coord(0)))
              .at(0, 0) == -5.0f);
}

TEST_CASE("what only one of two grids holds differs from the other's background, in tiles too") {
    const auto before = named("density");
    before->sparseFill(CoordBBox(Coord(0), Coord(127)), 2.0f, true);
    const auto after = named("density");
    after->tree().setValueOn(Coord(130, 3, 3), 4.0f);
    after->tree().setValueOn(Coord(5, 5, 5), 2.0f);
    const auto seen = largest_difference(*before, *after, View::z, CoordBBox(Coord(0), Coord(135)));
    CHECK(seen.at(0, 0) == -2.0f);
    CHECK(seen.at(127, 127) == -2.0f);
    CHECK(seen.at(130, 3) == 4.0f);
    CHECK(
        largest_difference(*before, *after, View::z, CoordBBox(Coord(0, 0, 5), Coord(135, 135, 5)))
            .at(5, 5) == 0.0f);
    CHECK(std::isnan(seen.at(129, 3)));
}

TEST_CASE("a difference of large tiles and of voxels far apart takes no more than what is there") {
    const auto before = named("density"), after = named("density");
    before->tree().root().addTile(Coord(0), 2.0f, true);
    before->tree().addTile(2, {-128, 0, 0}, 3.0f, true);
    after->tree().addTile(1, {16, 8, 0}, 5.0f, true);
    after->tree().setValueOn(Coord(-1, 7, 9), -4.0f);
    for (int n = 0; n < 200; ++n) after->tree().setValueOn(Coord(600 * n, 160 * n, 7), 1.0f);
    const CoordBBox near(Coord(-130, -3, 4), Coord(40, 40, 40));
    for (const auto view : {View::x, View::y, View::z}) {
        const auto seen = largest_difference(*before, *after, view, near);
        auto wanted = blank_projection(near, view, 1024, Projection::Keep::largest);
        for (const auto& at : near)
            if (before->tree().isValueOn(at) || after->tree().isValueOn(at))
                wanted.see(at, view, after->tree().getValue(at) - before->tree().getValue(at));
        REQUIRE(seen.values.size() == wanted.values.size());
        for (std::size_t n = 0; n < wanted.values.size(); ++n)
            CHECK((seen.values[n] == wanted.values[n] ||
                   (std::isnan(seen.values[n]) && std::isnan(wanted.values[n]))));
    }
    CHECK_FALSE(largest_difference(*before, *after, View::z,
                                   CoordBBox(Coord(-128, 0, 0), Coord(128'000, 32'000, 32'000)))
                    .empty());
}

TEST_CASE("a slice shows one plane, by nearest voxels where the grid has another transform") {
    const auto grid = named("energy");
    for (int y = 0; y < 4; ++y) grid->tree().setValueOn(Coord(1, y, 2), static_cast<float>(y));
    const auto& space = grid->transform();
    CHECK(slice_in(*grid, space, View::y, 2).at(1, 2) == 2.0f);
    CHECK(slice_in(*grid, space, View::y, 4).empty());
    CHECK(slice_in(*named("energy"), space, View::y, 0).empty());
    const auto fine = openvdb::math::Transform::createLinearTransform(0.5);
    const auto seen = slice_in(*grid, *fine, View::y, 6);
    CHECK(seen.at(2, 4) == 3.0f);
    CHECK(std::isnan(seen.at(4, 4)));
}
