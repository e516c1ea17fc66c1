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

#include <limits>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;
using test::failure_of;
using test::largest_error;
using test::NodeBench;
using test::rotation;
using test::sampled;
using test::sampled_staggered;

namespace {

constexpr double voxel = 0.25;
constexpr auto not_a_number = std::numeric_limits<float>::quiet_NaN();
const CoordBBox cube({-9, -9, -9}, {9, 9, 9});
const CoordBBox inner({-8, -8, -8}, {8, 8, 8});

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
    for (const auto mode : {FilterMode::mean, FilterMode::median, FilterMode::gaussian})
        CHECK(filtered_field(*FloatGrid::create(), mode, 1, 1)->empty());
}
