#include "nodes/field.h"
#include "carve/field/active_range.h"
#include "carve/field/collocate.h"
#include "carve/field/curl.h"
#include "carve/field/curvature.h"
#include "carve/field/filter.h"
#include "carve/field/gradient.h"
#include "carve/field/laplacian.h"
#include "carve/field/magnitude.h"
#include "formats/vdb/vdb_file.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"
#include "tests/support/vdb_grid.h"

#include <catch2/catch.hpp>

#include <numeric>
#include <set>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;
using test::failure_of;
using test::NodeBench;
using test::rotation;
using test::sampled;
using test::sampled_staggered;

namespace {

constexpr double voxel = 0.25;
constexpr auto not_a_number = std::numeric_limits<float>::quiet_NaN();
const CoordBBox cube({-9, -9, -9}, {9, 9, 9});
const CoordBBox inner({-8, -8, -8}, {8, 8, 8});

double difference(float a, float b) { return std::abs(a - b); }
double difference(const Vec3s& a, const Vec3s& b) { return (a - b).length(); }

/// The largest difference between a grid and `wanted(world position)` in a box.
template <class Grid, class Wanted>
double largest_error(const Grid& grid, const CoordBBox& box, const Wanted& wanted) {
    double out = 0;
    for (auto at = box.begin(); at; ++at)
        out = std::max(
            out, difference(grid.tree().getValue(*at), wanted(grid.indexToWorld((*at).asVec3d()))));
    return out;
}

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
                  ? std::max(out, difference(*value, other->tree().getValue(value.getCoord())))
                  : INFINITY;
    return out;
}

/// Active tiles of 8^3 in a plate with one missing.
FloatGrid::Ptr tiles() {
    const auto out = FloatGrid::create();
    for (int x = -2; x < 3; ++x)
        for (int y = -2; y < 3; ++y)
            if (x != 0 || y != 0) out->tree().addTile(1, {8 * x, 8 * y, 0}, 2.0f, true);
    return out;
}

const std::vector modes{FilterMode::mean, FilterMode::median, FilterMode::gaussian};

}  // namespace

TEST_CASE("a linear field has its slope as gradient, per world unit") {
    const auto field = sampled<FloatGrid>(
        cube, voxel, [](const Vec3d& p) { return float(7 + 2 * p.x() - 3 * p.y() + 6 * p.z()); });
    const auto gradient = gradient_field(*field);
    CHECK(largest_error(*gradient, inner, [](const Vec3d&) { return Vec3s(2, -3, 6); }) == 0);
    CHECK(gradient->activeVoxelCount() == cube.volume());
    CHECK(gradient->background() == Vec3s(0));
    CHECK(gradient->transform() == field->transform());
    CHECK(gradient->getName() == "gradient of sampled");
    CHECK(gradient->getVectorType() == openvdb::VEC_COVARIANT);
}

TEST_CASE("a rigid rotation has a curl of twice its angular velocity, staggered or not") {
    const Vec3d omega =
        GENERATE(Vec3d(0, 0, 1.5), Vec3d(2, 0, 0), Vec3d(0, -0.5, 0), Vec3d(0.3, -0.4, 1.2));
    const auto flow = [&](const Vec3d& p) { return rotation(omega, p); };
    const auto wanted = [&](const Vec3d&) { return Vec3s(2 * omega); };
    const auto curl = curl_field(sampled<VectorGrid>(cube, voxel, flow));
    CHECK(largest_error(*curl, inner, wanted) < 1e-5);
    CHECK(curl->activeVoxelCount() == cube.volume());
    CHECK(curl->getName() == "curl of sampled");
    const auto staggered = curl_field(sampled_staggered(cube, voxel, flow));
    CHECK(staggered->getGridClass() == openvdb::GRID_UNKNOWN);
    CHECK(largest_error(*staggered, {{-7, -7, -7}, {7, 7, 7}}, wanted) < 1e-5);
}

TEST_CASE("derivatives are by world units, whatever voxels a linear transform makes") {
    const auto placed = [](const auto& change) {
        const auto out = openvdb::math::Transform::createLinearTransform(voxel);
        change(*out);
        return out;
    };
    using Transform = openvdb::math::Transform;
    const auto transform =
        GENERATE_COPY(placed([](Transform& to) { to.postRotate(M_PI / 2, openvdb::math::Z_AXIS); }),
                      placed([](Transform& to) { to.postRotate(0.5, openvdb::math::Y_AXIS); }),
                      placed([](Transform& to) {
                          to.postScale({-1, 1, 1});
                      }),
                      placed([](Transform& to) {
                          to.postScale({1.01, 1, 2});
                      }),
                      placed([](Transform& to) {
                          to.postShear(0.3, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
                      }));
    const auto at_voxels = [&](const auto& value, auto grid) {
        grid->setTransform(transform->copy());
        for (auto at = cube.begin(); at; ++at)
            grid->tree().setValue(*at, value(grid->indexToWorld((*at).asVec3d())));
        return grid;
    };
    const auto slope =
        at_voxels([](const Vec3d& p) { return float(7 + 2 * p.x() - 3 * p.y() + 6 * p.z()); },
                  FloatGrid::create());
    CHECK(largest_error(*gradient_field(*slope), inner,
                        [](const Vec3d&) { return Vec3s(2, -3, 6); }) < 1e-5);
    const Vec3d omega(0.3, -0.4, 1.2);
    const auto spin =
        at_voxels([&](const Vec3d& p) { return rotation(omega, p); }, VectorGrid::create());
    CHECK(largest_error(*curl_field(spin), inner, [&](const Vec3d&) { return Vec3s(2 * omega); }) <
          1e-5);
    const auto bowl = at_voxels(
        [](const Vec3d& p) {
            return float(p.x() * p.x() + 2 * p.y() * p.y() - 0.5 * p.z() * p.z() + p.x() * p.y());
        },
        FloatGrid::create());
    CHECK(largest_error(*laplacian_field(*bowl), inner, [](const Vec3d&) { return 5.0f; }) < 1e-3);
    // Of level surfaces of p . p, spheres, of which second differences are exact.
    const auto ball =
        at_voxels([](const Vec3d& p) { return float(p.lengthSqr()); }, FloatGrid::create());
    const auto curvature = curvature_field(*ball);
    for (const auto& at : {Coord(6, 0, 0), Coord(-5, 4, 3), Coord(3, 3, -6)})
        CHECK(curvature->tree().getValue(at) ==
              Approx(2 / curvature->indexToWorld(at).length()).epsilon(1e-3));
}

TEST_CASE("derivatives need voxels of one shape, and finite values") {
    const auto field = FloatGrid::create();
    field->setName("density");
    field->setTransform(
        openvdb::math::Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 3.0, 0.1));
    CHECK(failure_of([&] { gradient_field(*field); }) ==
          "grid 'density' has voxels of varying shape (NonlinearFrustumMap); derivatives need "
          "voxels of one shape, as grid.resample makes them");
    const auto velocity = VectorGrid::create();
    velocity->setName("velocity");
    velocity->setGridClass(openvdb::GRID_STAGGERED);
    velocity->transform().postRotate(0.5, openvdb::math::Z_AXIS);
    CHECK(failure_of([&] { curl_field(velocity); }) ==
          "grid 'velocity' is staggered on turned voxels, so that nobody can tell which way its "
          "components point; store it collocated");
    velocity->setGridClass(openvdb::GRID_UNKNOWN);
    velocity->setTransform(openvdb::math::Transform::createLinearTransform(1));
    velocity->tree().setValue({1, 2, 3}, Vec3s(0, not_a_number, 0));
    const std::string message =
        "grid 'velocity' has a value that is not finite (NaN or infinite) at voxel [1, 2, 3]; "
        "repair it where it comes from";
    CHECK(failure_of([&] { curl_field(velocity); }) == message);
    CHECK(failure_of([&] { magnitude_field(velocity); }) == message);
}

TEST_CASE(
    "the magnitude is the length of each vector, of a tile too, whatever the shape of the voxels") {
    const auto velocity = VectorGrid::create(Vec3s(0, 3, 4));
    velocity->setName("velocity");
    velocity->transform().postScale({1, 2, 1});
    velocity->tree().addTile(1, {64, 0, 0}, Vec3s(3, 4, 12), true);
    velocity->tree().setValue({1, 2, 3}, Vec3s(-2, 3, 6));
    const auto magnitude = magnitude_field(velocity);
    CHECK(magnitude->tree().getValue({1, 2, 3}) == 7);
    CHECK(magnitude->tree().getValue({66, 2, 3}) == 13);
    CHECK(magnitude->background() == 5);
    CHECK(magnitude->tree().hasSameTopology(velocity->tree()));
    CHECK(magnitude->transform() == velocity->transform());
    CHECK(magnitude->getName() == "magnitude of velocity");
    const auto staggered =
        sampled_staggered(cube, voxel, [](const Vec3d& p) { return Vec3s(float(p.x()), 0, 0); });
    CHECK(largest_error(*magnitude_field(staggered), inner,
                        [](const Vec3d& p) { return float(std::abs(p.x())); }) == 0);
}

TEST_CASE("the field nodes hand on what their functions give") {
    const auto output = [](NodeType type, const std::string& input, const Payload& grid,
                           const std::string& name) {
        return NodeBench(std::move(type)).run({{input, {grid}}}).at(name);
    };
    const auto staggered = sampled_staggered(
        cube, voxel, [](const Vec3d& p) { return Vec3s(float(p.z()), float(p.x()), 1); });
    const Ref<FloatGrid> field =
        sampled<FloatGrid>(cube, voxel, [](const Vec3d& p) { return float(p.x() * p.y()); });
    const Payload flow{Ref<VectorGrid>(staggered)};
    CHECK(test::difference(
              *output(field_gradient(), "field", Payload(field), "gradient").as<VectorGrid>(),
              *gradient_field(*field)) == "");
    CHECK(test::difference(*output(field_curl(), "velocity", flow, "curl").as<VectorGrid>(),
                           *curl_field(staggered)) == "");
    CHECK(test::difference(*output(field_magnitude(), "vectors", flow, "magnitude").as<FloatGrid>(),
                           *magnitude_field(staggered)) == "");
    const auto centred = output(field_collocate(), "velocity", flow, "velocity").as<VectorGrid>();
    CHECK(test::difference(*centred, *collocated(staggered)) == "");
    CHECK(output(field_collocate(), "velocity", Payload(centred), "velocity").as<VectorGrid>() ==
          centred);
}

TEST_CASE("a constant field filters to itself, in voxels and in tiles") {
    const auto field = FloatGrid::create(0.3f);
    field->tree().addTile(1, {16, 0, 0}, 0.3f, true);
    for (auto at = cube.begin(); at; ++at) field->tree().setValue(*at, 0.3f);
    for (const auto mode : modes)
        CHECK(largest_difference(*filtered_field(*field, mode, 2, 2), *field) < 1e-6);
}

TEST_CASE(
    "a filter sees around the corners of tiles: the same values in voxels give the same result") {
    const auto sparse = tiles(), dense = tiles();
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
    const auto field = sampled<FloatGrid>(cube, voxel, [](const Vec3d&) { return 0.0f; });
    field->tree().setValue({2, 3, 4}, 27.0f);
    const auto mean = filtered_field(*field, FilterMode::mean, 1, 1);
    const CoordBBox near({1, 2, 3}, {3, 4, 5});
    for (auto at = cube.begin(); at; ++at)
        CHECK(mean->tree().getValue(*at) == Approx(near.isInside(*at) ? 1 : 0));
    CHECK(filtered_field(*field, FilterMode::mean, 2, 1)->tree().getValue({4, 1, 2}) ==
          Approx(27.0 / 125));
    CHECK(largest_error(*filtered_field(*field, FilterMode::median, 1, 1), cube,
                        [](const Vec3d&) { return 0.0f; }) == 0);
    CHECK(mean->getName() == "mean of sampled");
}

TEST_CASE("a median keeps a straight edge, where a mean blurs it") {
    const auto edge = [](const Vec3d& p) { return p.x() < 0 ? 1.0f : 5.0f; };
    const auto field = sampled<FloatGrid>(cube, voxel, edge);
    const CoordBBox away({-6, -6, -6}, {6, 6, 6});
    CHECK(largest_error(*filtered_field(*field, FilterMode::median, 2, 1), away, edge) == 0);
    CHECK(filtered_field(*field, FilterMode::mean, 1, 1)->tree().getValue({0, 0, 0}) ==
          Approx((1 + 2 * 5) / 3.0));
}

TEST_CASE("a filter leaves a linear field alone, away from its border") {
    const auto ramp = [](const Vec3d& p) { return float(1 + p.x() - 2 * p.z()); };
    const auto field = sampled<FloatGrid>(cube, voxel, ramp);
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
    const auto field = sampled<FloatGrid>(cube, voxel, [](const Vec3d&) { return 1.0f; });
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

    const auto vast = sampled<FloatGrid>(cube, voxel, [](const Vec3d&) { return 3e38f; });
    CHECK(failure_of([&] { filtered_field(*vast, FilterMode::mean, 1, 1); }) ==
          "grid 'sampled' has values of up to 3e+38, so large that what is computed from them at "
          "voxel [-9, -9, -9] has no number: make them smaller with "
          "field.ax");
}

TEST_CASE("field.filter's parameters are checked, and handed on") {
    const auto faults = [](const std::string& yaml) {
        return NodeBench(field_filter(), yaml).faults();
    };
    CHECK(faults("mode: box") == "mode must be one of mean, median, gaussian, not 'box'\n");
    CHECK(faults("width: 0") == "width must be from 1 to 64, not 0\n");
    CHECK(faults("iterations: 0") == "iterations must be from 1 to 100, not 0\n");
    CHECK(faults("width: 1.5") == "width must be a whole number, not '1.5'\n");
    const auto path = std::string(TEST_DATA) + "/plume/plume.0053.vdb";
    const Ref<FloatGrid> density = openvdb::gridPtrCast<FloatGrid>(read_vdb_grid(path, "density"));
    NodeBench node(field_filter(), "{mode: gaussian, width: 2, iterations: 2}");
    const auto filtered = node.run({{"field", {Payload(density)}}}).at("filtered").as<FloatGrid>();
    CHECK(test::difference(*filtered, *filtered_field(*density, FilterMode::gaussian, 2, 2)) == "");
    CHECK(filtered->getName() == "gaussian of density");
    CHECK(active_range(*filtered).high < 0.9 * active_range(*density).high);
    CHECK(filtered->activeVoxelCount() == density->activeVoxelCount());
}

TEST_CASE("empty grids have empty fields") {
    CHECK(gradient_field(*FloatGrid::create())->empty());
    CHECK(curl_field(VectorGrid::create())->empty());
    CHECK(magnitude_field(VectorGrid::create())->empty());
    for (const auto mode : modes) CHECK(filtered_field(*FloatGrid::create(), mode, 1, 1)->empty());
}
