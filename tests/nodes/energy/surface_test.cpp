#include "carve/energy/surface.h"
#include "carve/energy/combine.h"
#include "carve/energy/curvature.h"
#include "carve/energy/kinetic.h"
#include "carve/field/active_range.h"
#include "carve/field/curvature.h"
#include "carve/field/laplacian.h"
#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "carve/sdf/from_points.h"
#include "formats/points_file/points_file.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/energy.h"
#include "nodes/sdf.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"
#include "tests/support/sampled.h"
#include "tests/support/vdb_grid.h"
#include "tests/support/wavy_seams.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <functional>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

constexpr double fine_voxel = 0.125;
const CoordBBox fine_cube({-24, -24, -24}, {24, 24, 24});

/// The largest error of the curvature where a distance is within `band` of its zero, against a
/// formula by position.
double curvature_error(const std::function<double(const Vec3d&)>& distance,
                       const std::function<double(double)>& field,
                       const std::function<double(const Vec3d&)>& wanted, double band) {
    const auto grid = sampled<FloatGrid>(fine_cube, fine_voxel, [&](const Vec3d& at) {
        return static_cast<float>(field(distance(at)));
    });
    const auto curvature = curvature_field(*grid);
    auto inner = fine_cube;
    inner.expand(-1);
    double worst = 0;
    int looked = 0;
    for (auto at = inner.begin(); at; ++at) {
        const auto p = grid->indexToWorld((*at).asVec3d());
        if (std::abs(distance(p)) > band) continue;
        ++looked;
        worst = std::max(worst, std::abs(curvature->tree().getValue(*at) - wanted(p)));
    }
    return looked > 100 ? worst : 1e9;
}

const std::string river_43 = std::string(TEST_DATA) + "/river/river.0043.vdb";

Payload energy_of(std::map<std::string, Payload> outputs) { return outputs.at("energy"); }

}  // namespace

TEST_CASE(
    "spheres, cylinders, tori and planes have their known curvature, as distances and as fields "
    "that are none") {
    const auto field = GENERATE(
        std::function<double(double)>([](double d) { return d; }),
        std::function<double(double)>([](double d) { return 40 * d; }),
        std::function<double(double)>([](double d) { return std::tanh(d) + 0.1 * d * d * d; }));
    const auto sphere = [](const Vec3d& p) { return p.length() - 2; };
    const auto cylinder = [](const Vec3d& p) { return std::hypot(p.x() - 0.1, p.z()) - 1.5; };
    const auto ring = [](const Vec3d& p) { return std::hypot(p.x(), p.y()); };
    const auto torus = [&](const Vec3d& p) { return std::hypot(ring(p) - 1.75, p.z()) - 0.75; };
    const auto plane = [](const Vec3d& p) { return p.dot(Vec3d(0.48, -0.6, 0.64)) - 0.1; };
    CHECK(curvature_error(
              sphere, field, [](const Vec3d& p) { return 2 / p.length(); }, 0.4) < 0.01);
    CHECK(curvature_error(
              cylinder, field, [](const Vec3d& p) { return 1 / std::hypot(p.x() - 0.1, p.z()); },
              0.4) < 0.015);
    CHECK(curvature_error(
              torus, field,
              [&](const Vec3d& p) {
                  return 1 / std::hypot(ring(p) - 1.75, p.z()) +
                         (1 - 1.75 / ring(p)) / std::hypot(ring(p) - 1.75, p.z());
              },
              0.2) < 0.06);
    CHECK(curvature_error(
              plane, field, [](const Vec3d&) { return 0.0; }, 0.4) < 5e-3);
}

TEST_CASE("curvature has the sign of the side, and its energy has none") {
    const auto bubble = sampled<FloatGrid>(
        fine_cube, fine_voxel, [](const Vec3d& at) { return static_cast<float>(2 - at.length()); });
    CHECK(curvature_field(*bubble)->tree().getValue({16, 0, 0}) == Approx(-1).epsilon(0.01));
    CHECK(curvature_energy(*bubble, 3)->tree().getValue({16, 0, 0}) == Approx(3).epsilon(0.01));
    CHECK(curvature_energy(*bubble, 3)->getName() == "curvature of sampled");
    CHECK(curvature_field(*bubble)->transform() == bubble->transform());
    CHECK(curvature_field(*bubble)->activeVoxelCount() == bubble->activeVoxelCount());
}

TEST_CASE("the end of a narrow band is no edge, and a point no more than a ball of a voxel") {
    const auto band = FloatGrid::create(0.375f);
    band->setTransform(openvdb::math::Transform::createLinearTransform(fine_voxel));
    band->setGridClass(openvdb::GRID_LEVEL_SET);
    for (auto at = fine_cube.begin(); at; ++at) {
        const auto distance = band->indexToWorld((*at).asVec3d()).length() - 2;
        if (std::abs(distance) < 0.375) band->tree().setValue(*at, static_cast<float>(distance));
    }
    const auto range = active_range(*curvature_field(*band));
    CHECK(range.low == 0);
    CHECK(range.high < 1.2);
    CHECK(range.high > 0.98);

    const auto cone = sampled<FloatGrid>(fine_cube, fine_voxel, [](const Vec3d& at) {
        return static_cast<float>((at - Vec3d(0.01)).length());
    });
    const auto peak = active_range(*curvature_field(*cone));
    CHECK(peak.high == Approx(2 / fine_voxel));
    CHECK(curvature_field(*cone)->tree().getValue({8, 0, 0}) == Approx(2).epsilon(0.05));
}

TEST_CASE(
    "the laplacian of a quadratic field is exact, and what it holds beyond its active voxels "
    "counts") {
    const auto field = sampled<FloatGrid>(fine_cube, fine_voxel, [](const Vec3d& p) {
        return static_cast<float>(p.x() * p.x() + 2 * p.y() * p.y() - 0.5 * p.z() * p.z() + p.x());
    });
    const auto laplacian = laplacian_field(*field);
    CHECK(laplacian->tree().getValue({3, -5, 7}) == Approx(5).epsilon(1e-3));
    CHECK(laplacian->getName() == "laplacian of sampled");
    const auto one = FloatGrid::create(0);
    one->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    one->tree().setValue({0, 0, 0}, 3);
    one->tree().setValueOff({1, 0, 0}, 2);
    CHECK(laplacian_field(*one)->tree().getValue({0, 0, 0}) == Approx((2 - 18) / 0.25));
    CHECK(laplacian_field(*one)->activeVoxelCount() == 1);
}

TEST_CASE("fields that are not finite, or on voxels that differ in shape, are refused") {
    const auto field =
        sampled<FloatGrid>(CoordBBox({0, 0, 0}, {3, 3, 3}), fine_voxel,
                           [](const Vec3d& at) { return static_cast<float>(at.x()); });
    field->tree().setValue({1, 1, 1}, NAN);
    for (const auto& of : {curvature_field, laplacian_field})
        CHECK(failure_of([&] { of(*field); }).find("'sampled'") != std::string::npos);
    field->tree().setValue({1, 1, 1}, 0);
    field->setTransform(
        openvdb::math::Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 3.0, 0.1));
    for (const auto& of : {curvature_field, laplacian_field})
        CHECK(failure_of([&] { of(*field); }).find("derivatives need voxels of one shape") !=
              std::string::npos);
}

TEST_CASE("a point becomes a ball, points the union of theirs") {
    const auto transform = openvdb::math::Transform::createLinearTransform(fine_voxel);
    transform->postTranslate(Vec3d(0.03, -0.2, 0.5));
    const std::vector<Vec3d> centres{Vec3d(0.1, 0.2, 0.3), Vec3d(0.55, 0.2, 0.3), Vec3d(-2, 1, 0)};
    const auto surface = sdf_of_points(points_at(centres), *transform, {3, 0, 4});
    CHECK(surface->getGridClass() == openvdb::GRID_LEVEL_SET);
    CHECK(surface->background() == 0.5f);
    CHECK(surface->transform() == *transform);
    int looked = 0;
    for (auto value = surface->cbeginValueOn(); value; ++value) {
        const auto at = surface->indexToWorld(value.getCoord());
        double distance = 1e9;
        for (const auto& centre : centres)
            distance = std::min(distance, (at - centre).length() - 3 * fine_voxel);
        REQUIRE(*value == Approx(distance).margin(1e-5));
        ++looked;
    }
    CHECK(looked > 1500);
    CHECK(surface->tree().getValue(Coord::round(surface->worldToIndex(centres[0]))) < 0);
    CHECK(surface->tree().getValue({100, 100, 100}) == 0.5f);

    const auto none = sdf_of_points(points_at({}), *transform, {3, 2, 4});
    CHECK(none->activeVoxelCount() == 0);
    CHECK(none->background() == 0.5f);
    CHECK(none->getGridClass() == openvdb::GRID_LEVEL_SET);
    CHECK(curvature_field(*none)->activeVoxelCount() == 0);
}

TEST_CASE(
    "a point on a voxel's centre makes a ball without a hole, and balls may be as large as they "
    "can be stated") {
    const auto transform = openvdb::math::Transform::createLinearTransform(fine_voxel);
    const auto whole = [](const FloatGrid& surface, const Coord& middle, double radius) {
        // What is no deeper than the band has a distance of its own.
        for (auto at = CoordBBox(middle.offsetBy(-2), middle.offsetBy(2)).begin(); at; ++at) {
            const auto distance = ((*at - middle).asVec3d().length() - radius) * fine_voxel;
            REQUIRE(surface.tree().isValueOn(*at));
            REQUIRE(surface.tree().getValue(*at) == Approx(distance).margin(1e-5));
        }
    };
    for (const auto& middle : {Coord(0, 0, 0), Coord(3, -5, 7), Coord(100000000, -5, 7)})
        for (const double radius : {1.5, 3.0}) {
            INFO(middle << ' ' << radius);
            whole(*sdf_of_points(points_at({transform->indexToWorld(middle)}), *transform,
                                 {radius, 0, 3.01}),
                  middle, radius);
        }
    CHECK(failure_of([&] {
              sdf_of_points(points_at({Vec3d(1e12, 0, 0)}), *transform, {});
          }).find("is too far from the grid's origin") != std::string::npos);

    const auto small = openvdb::math::Transform::createLinearTransform(0.014);
    const auto large = sdf_of_points(points_at({Vec3d(0.1, 0.2, 0.3)}), *small, {100, 0, 3});
    CHECK(large->tree().getValue(Coord::round(small->worldToIndex(Vec3d(0.1 + 1.4, 0.2, 0.3)))) ==
          Approx(0).margin(0.014));
    CHECK(large->activeVoxelCount() > 500000);
}

TEST_CASE(
    "particles and grids of Blender's liquids make a surface in one place, the same for any number "
    "of threads") {
    const auto points =
        std::make_shared<Points>(read_points(river_43, "", PointOffset::detect, {}));
    const auto volume = read_vdb(river_43);
    NodeBench node(sdf_from_points(), "{radius: 1.25, smoothing: 2}", {{"like", 1}});
    REQUIRE(node.faults() == "");
    const NodeBench::Inputs inputs{
        {"points", {Payload(points)}},
        {"like", {Payload(std::make_shared<AnyGrid>(AnyGrid{volume.find("velocity")}))}}};
    const auto surface = node.run(inputs).at("surface").as<FloatGrid>();
    CHECK(surface->transform() == volume.find("velocity")->transform());
    // Blender keeps velocities where there is liquid, and around it.
    const auto velocity = openvdb::gridConstPtrCast<VectorGrid>(volume.find("velocity"));
    int inside = 0, with_velocity = 0;
    for (auto value = surface->cbeginValueOn(); value; ++value) {
        if (*value >= 0) continue;
        ++inside;
        with_velocity += velocity->tree().isValueOn(value.getCoord());
    }
    CHECK(inside > 1000);
    CHECK(with_velocity > 0.9 * inside);
    tbb::task_arena one(1);
    one.execute([&] {
        CHECK(bytes(node.run(inputs).at("surface").as<FloatGrid>()->tree()) ==
              bytes(surface->tree()));
    });

    CHECK(NodeBench(sdf_from_points()).faults() ==
          "type: needs 'voxel_size', or a grid 'like' whose voxels it takes\n");
    CHECK(NodeBench(sdf_from_points(), "{voxel_size: 1}", {{"like", 1}}).faults() ==
          "voxel_size: 'like' already states the voxels; leave 'like' or 'voxel_size' out\n");
    NodeBench alone(sdf_from_points(), "{voxel_size: 0.1}");
    CHECK(alone.run({{"points", {Payload(points)}}}).at("surface").as<FloatGrid>()->voxelSize() ==
          Vec3d(0.1));
}

TEST_CASE("smoothing makes a surface of particles less rough") {
    const auto points = points_at(scattered({Vec3d(-1.5), Vec3d(1.5)}, 3000, 3));
    const auto transform = openvdb::math::Transform::createLinearTransform(fine_voxel);
    const auto mean = [&](int smoothing) {
        const auto energy =
            curvature_energy(*sdf_of_points(points, *transform, {1.5, smoothing, 3}), 1);
        double sum = 0;
        for (auto value = energy->cbeginValueOn(); value; ++value) sum += *value;
        return sum / static_cast<double>(energy->activeVoxelCount());
    };
    CHECK(mean(3) < 0.6 * mean(0));
}

TEST_CASE("carved particles make the surface that their carved surface is, but for the seams") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const auto points = read_points(river_43, "", PointOffset::detect, {});
    const auto cells = openvdb::math::Transform::createLinearTransform(0.0625);
    const auto& transform = *cells;
    const Splat splat{1.5, 0, 3};
    // Across the stream, at an angle to the voxels and with vertices that are none of them.
    const auto lattice = turned(
        make_box(transform.indexToWorld(Vec3d(44.3, 2.2, 1.7)), {42, 30, 16}, 0.0625, {1, 0, 2}),
        -0.12);
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, kind, 16, 3, 1.0)});
    const FloatGrid::ConstPtr before = sdf_of_points(points, transform, splat);
    const auto by_grid = openvdb::gridConstPtrCast<FloatGrid>(
        carve_grid(before, lattice, map, Interpolation::linear));
    const auto carved =
        carve_points(points.positions(), points.identities(), lattice, map, default_jitter);
    const auto by_points = sdf_of_points(with_images(points, carved.images), transform, splat);

    const Mapping mapping(lattice, map.reach());
    const auto& step = map.steps()[0];
    double sum = 0, was = 0;
    int looked = 0;
    for (auto value = by_points->cbeginValueOn(); value; ++value) {
        if (std::abs(*value) > 0.0625) continue;
        const auto at = mapping.locate(by_points->indexToWorld(value.getCoord()));
        if (!at || at->x() > step.after() - 4 || at->y() < 3 || at->y() > 26 || at->z() < 1 ||
            at->z() > 14)
            continue;
        const auto bounds =
            step.first_displaced(static_cast<int>(at->y()), static_cast<int>(at->z()));
        if (at->x() < bounds.back() + 5) continue;
        sum += std::abs(*value - by_grid->tree().getValue(value.getCoord())) / 0.0625;
        was += std::abs(*value - before->tree().getValue(value.getCoord())) / 0.0625;
        ++looked;
    }
    REQUIRE(looked > 500);
    CHECK(sum / looked < 0.25);
    CHECK(was / looked > 3 * sum / looked);
}

TEST_CASE("energy.surface is what the graph of single nodes is") {
    struct Frame {
        FloatGrid::ConstPtr surface;
        VectorGrid::ConstPtr velocity;
    };
    std::vector<Frame> frames;
    for (const int number : {43, 44}) {
        const auto path = fmt::format("{}/river/river.00{}.vdb", TEST_DATA, number);
        const auto velocity = openvdb::gridPtrCast<VectorGrid>(read_vdb_grid(path, "velocity"));
        frames.push_back({sdf_of_points(read_points(path, "", PointOffset::detect, {}),
                                        velocity->transform(), {}),
                          velocity});
    }
    const auto inputs = [](const Frame& frame) {
        return NodeBench::Inputs{{"surface", {Payload(frame.surface)}},
                                 {"velocity", {Payload(frame.velocity)}}};
    };
    const auto terms = [](const Frame& frame) {
        NodeBench curvature(energy_curvature()), kinetic(energy_kinetic());
        return NodeBench::Inputs{
            {"terms",
             {energy_of(curvature.run({{"surface", {Payload(frame.surface)}}})),
              energy_of(kinetic.run({{"velocity", {Payload(frame.velocity)}}}))}}};
    };
    const auto& [surface_yaml, combine_yaml] =
        GENERATE(std::pair("{}", "{weights: [1, 1]}"),
                 std::pair("{kinetic: 0.25, range: [auto, [0, 40]]}",
                           "{weights: [1, 0.25], range: [auto, [0, 40]]}"),
                 std::pair("{curvature: 2, range: [0, 9]}", "{weights: [2, 1], range: [0, 9]}"));
    NodeBench surface(energy_surface(), surface_yaml, {{"surface", 1}, {"velocity", 1}});
    NodeBench combine(energy_combine(), combine_yaml, {{"terms", 2}});
    REQUIRE(surface.faults() == "");
    REQUIRE(surface.gathers() == combine.gathers());
    if (surface.gathers()) {
        for (const auto& frame : frames) surface.add(inputs(frame)), combine.add(terms(frame));
        surface.finish();
        combine.finish();
    }
    for (const auto& frame : frames) {
        const auto one = energy_of(surface.run(inputs(frame))).as<FloatGrid>(),
                   other = energy_of(combine.run(terms(frame))).as<FloatGrid>();
        CHECK(difference(*one, *other) == "");
        CHECK(active_range(*one).high > active_range(*one).low);
    }
    NodeBench alone(energy_surface(), "{curvature: 3, range: [0, 20]}", {{"surface", 1}});
    CHECK(difference(
              *energy_of(alone.run({{"surface", {Payload(frames[0].surface)}}})).as<FloatGrid>(),
              *combined_energy({{curvature_energy(*frames[0].surface, 1), 3, {0, 20}}})) == "");
    CHECK(NodeBench(energy_surface(), "{kinetic: 2}", {{"surface", 1}}).faults() ==
          "kinetic: 'kinetic' is the weight of a term that needs 'velocity': connect 'velocity', "
          "or leave 'kinetic' out\n");
    CHECK(
        NodeBench(energy_surface(), "range: [auto]", {{"surface", 1}, {"velocity", 1}}).faults() ==
        "range: states 1 ranges for 2 terms; state one per term\n");
}
