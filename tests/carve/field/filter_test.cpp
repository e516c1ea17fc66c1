#include "carve/field/filter.h"
#include "tests/support/failure_of.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/sampled.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <vector>

using namespace fluidcarve;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using test::failure_of;
using test::largest_error;
using test::sampled;

namespace {

constexpr double voxel = 0.25;
constexpr auto not_a_number = std::numeric_limits<float>::quiet_NaN();
const CoordBBox block({-9, -9, -9}, {9, 9, 9});
const std::vector modes{FilterMode::mean, FilterMode::median, FilterMode::gaussian};

/// The largest difference of two grids, both ways round, over their active voxels; infinite if
/// these are not the same.
double largest_difference(const FloatGrid& a, const FloatGrid& b) {
    auto one = a.deepCopy(), other = b.deepCopy();
    one->tree().voxelizeActiveTiles();
    other->tree().voxelizeActiveTiles();
    if (one->activeVoxelCount() != other->activeVoxelCount()) return INFINITY;
    double out = 0;
    for (auto value = one->cbeginValueOn(); value; ++value)
        out = other->tree().isValueOn(value.getCoord())
                  ? std::max(out, static_cast<double>(
                                      std::abs(*value - other->tree().getValue(value.getCoord()))))
                  : INFINITY;
    return out;
}

/// Active tiles of 8^3 in a plate with one missing.
FloatGrid::Ptr plate() {
    const auto out = FloatGrid::create();
    for (int x = -2; x < 3; ++x)
        for (int y = -2; y < 3; ++y)
            if (x != 0 || y != 0) out->tree().addTile(1, {8 * x, 8 * y, 0}, 2.0f, true);
    return out;
}

}  // namespace

TEST_CASE("a constant field filters to itself, in voxels and in tiles") {
    const auto field = FloatGrid::create(0.3f);
    field->tree().addTile(1, {16, 0, 0}, 0.3f, true);
    for (auto at = block.begin(); at; ++at) field->tree().setValue(*at, 0.3f);
    for (const auto mode : modes)
        CHECK(largest_difference(*filtered_field(*field, mode, 2, 2), *field) < 1e-6);
}

TEST_CASE(
    "a filter sees around the corners of tiles: the same values in voxels give the same result") {
    const auto sparse = plate(), dense = plate();
    dense->tree().voxelizeActiveTiles();
    for (const auto mode : modes)
        for (const int width : {1, 2}) {
            INFO("mode " << int(mode) << ", width " << width);
            CHECK(largest_difference(*filtered_field(*sparse, mode, width, 1),
                                     *filtered_field(*dense, mode, width, 1)) == 0);
        }
}

TEST_CASE("a filter opens a large tile as deep as it reaches, and leaves the rest") {
    const auto sparse = FloatGrid::create();
    sparse->tree().addTile(2, {0, 0, 0}, 2.0f, true);
    const auto filtered = filtered_field(*sparse, FilterMode::mean, 3, 3);  // reaches 9 voxels
    CHECK(filtered->tree().activeTileCount() == 12 * 12 * 12);
    CHECK(filtered->tree().getValue({64, 64, 64}) == 2);
    // Along each axis for itself: 1 within the tile and 0 beyond.
    std::vector<double> line(128 + 6, 0);
    std::fill(line.begin() + 3, line.end() - 3, 1);
    for (int n = 0; n < 3; ++n) {
        const auto last = line;
        for (std::size_t at = 3; at < 131; ++at)
            line[at] = std::accumulate(last.begin() + static_cast<std::ptrdiff_t>(at) - 3,
                                       last.begin() + static_cast<std::ptrdiff_t>(at) + 4, 0.0) /
                       7;
    }
    double worst = 0;
    for (int z = 0; z < 128; ++z)
        for (int x = 0; x < 64; ++x)
            for (const int y : {0, 3, 9, 15, 16, 40, 124})
                worst = std::max(worst,
                                 std::abs(filtered->tree().getValue({x, y, z}) -
                                          2 * line[std::size_t(x + 3)] * line[std::size_t(y + 3)] *
                                              line[std::size_t(z + 3)]));
    CHECK(worst < 1e-5);
}

TEST_CASE("a mean spreads a spike over its cube, and a median removes it") {
    const auto field = sampled<FloatGrid>(block, voxel, [](const Vec3d&) { return 0.0f; });
    field->tree().setValue({2, 3, 4}, 27.0f);
    const auto mean = filtered_field(*field, FilterMode::mean, 1, 1);
    const CoordBBox near({1, 2, 3}, {3, 4, 5});
    for (auto at = block.begin(); at; ++at)
        CHECK(mean->tree().getValue(*at) == Approx(near.isInside(*at) ? 1 : 0));
    CHECK(filtered_field(*field, FilterMode::mean, 2, 1)->tree().getValue({4, 1, 2}) ==
          Approx(27.0 / 125));
    CHECK(largest_error(*filtered_field(*field, FilterMode::median, 1, 1), block,
                        [](const Vec3d&) { return 0.0f; }) == 0);
    CHECK(mean->getName() == "mean of sampled");
}

TEST_CASE("a median keeps a straight edge, where a mean blurs it") {
    const auto edge = [](const Vec3d& p) { return p.x() < 0 ? 1.0f : 5.0f; };
    const auto field = sampled<FloatGrid>(block, voxel, edge);
    const CoordBBox away({-6, -6, -6}, {6, 6, 6});
    CHECK(largest_error(*filtered_field(*field, FilterMode::median, 2, 1), away, edge) == 0);
    CHECK(filtered_field(*field, FilterMode::mean, 1, 1)->tree().getValue({0, 0, 0}) ==
          Approx((1 + 2 * 5) / 3.0));
}

TEST_CASE("a filter leaves a linear field alone, away from its border") {
    const auto ramp = [](const Vec3d& p) { return float(1 + p.x() - 2 * p.z()); };
    const auto field = sampled<FloatGrid>(block, voxel, ramp);
    for (const auto mode : modes)
        CHECK(largest_error(*filtered_field(*field, mode, 1, 1), {{-5, -5, -5}, {5, 5, 5}}, ramp) <
              1e-5);
}

TEST_CASE("the gaussian is four means, and its variance is as documented") {
    const auto field = FloatGrid::create();
    field->setTransform(openvdb::math::Transform::createLinearTransform(1));
    const CoordBBox space({-9, -9, -9}, {9, 9, 9});
    field->denseFill(space, 0.0f, true);
    field->tree().setValue({0, 0, 0}, 1.0f);
    for (const int width : {1, 2}) {
        const auto gaussian = filtered_field(*field, FilterMode::gaussian, width, 1);
        CHECK(largest_difference(*gaussian, *filtered_field(*field, FilterMode::mean, width, 4)) ==
              0);
        double sum = 0, variance = 0;
        for (auto value = gaussian->cbeginValueOn(); value; ++value) {
            sum += *value;
            variance += double(*value) * value.getCoord().x() * value.getCoord().x();
        }
        CHECK(sum == Approx(1));
        CHECK(variance == Approx(4 * width * (width + 1) / 3.0));
    }
}

TEST_CASE("a filter changes active values only, and keeps all else of the grid") {
    const auto field = sampled<FloatGrid>({{0, 0, 0}, {5, 5, 5}}, voxel,
                                          [](const Vec3d& p) { return float(p.x()); });
    field->setGridClass(openvdb::GRID_FOG_VOLUME);
    field->setSaveFloatAsHalf(true);
    field->insertMeta("note", openvdb::StringMetadata("kept"));
    field->tree().setValueOff({6, 0, 0}, 9.0f);
    for (const auto mode : modes) {
        const auto filtered = filtered_field(*field, mode, 1, 2);
        CHECK(filtered->tree().hasSameTopology(field->tree()));
        CHECK(filtered->tree().getValue({6, 0, 0}) == 9);
        CHECK(filtered->tree().getValue({7, 0, 0}) == 0);
        CHECK(filtered->transform() == field->transform());
        filtered->setName(field->getName());
        filtered->setTree(field->treePtr());
        CHECK(test::difference(*filtered, *field) == "");
    }
    // What an inactive voxel holds counts for its neighbours.
    CHECK(filtered_field(*field, FilterMode::mean, 1, 1)->tree().getValue({5, 1, 1}) ==
          Approx((9 * (1 + 1.25) + 9) / 27));
}

TEST_CASE("a filter refuses values that are not finite, on its voxels or near them") {
    const auto refusal = [](const FloatGrid& field, int width = 1) {
        std::set<std::string> out;
        for (const auto mode : modes)
            out.insert(failure_of([&] { filtered_field(field, mode, width, 2); }));
        return out;
    };
    using Messages = std::set<std::string>;
    const auto field = sampled<FloatGrid>(block, voxel, [](const Vec3d&) { return 1.0f; });
    CHECK(refusal(*field) == Messages{""});
    field->tree().setValueOff({0, 12, 0}, not_a_number);
    CHECK(refusal(*field, 2) == Messages{""});
    CHECK(refusal(*field, 3) ==
          Messages{"grid 'sampled' has a value that is not finite (NaN or infinite) next to voxel "
                   "[-3, 9, -3]; repair it where it comes from"});
    field->tree().setValue({5, 1, 1}, std::numeric_limits<float>::infinity());
    field->tree().setValue({4, 1, 1}, -not_a_number);
    CHECK(refusal(*field) ==
          Messages{"grid 'sampled' has a value that is not finite (NaN or infinite) at voxel [4, "
                   "1, 1]; repair it where it comes from"});

    const auto tile = FloatGrid::create();
    tile->setName("tile");
    tile->tree().addTile(2, {128, 0, 0}, not_a_number, true);
    CHECK(refusal(*tile) == Messages{"grid 'tile' has a value that is not finite (NaN or infinite) "
                                     "at voxel [128, 0, 0]; repair it where it comes from"});

    const auto vast = sampled<FloatGrid>(block, voxel, [](const Vec3d&) { return 3e38f; });
    CHECK(failure_of([&] { filtered_field(*vast, FilterMode::mean, 1, 1); }) ==
          "grid 'sampled' has values of up to 3e+38, so large that what is computed from them at "
          "voxel [-9, -9, -9] has no number: make them smaller with "
          "field.ax");
}
