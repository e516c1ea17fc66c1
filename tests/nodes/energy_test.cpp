#include "nodes/energy/combine.h"
#include "nodes/energy/gradient.h"
#include "nodes/energy/vorticity.h"
#include "nodes/field/collocate.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;
using test::failure_of;
using test::NodeBench;

namespace {

constexpr double voxel = 0.25;
const CoordBBox cube({-9, -9, -9}, {9, 9, 9});

/// `value(world position)` at each voxel of a box; component c of a staggered grid on its face.
template <class Grid, class Value>
typename Grid::Ptr sampled(const CoordBBox& box, const Value& value) {
    const auto out = Grid::create();
    out->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    out->setName("sampled");
    auto accessor = out->getAccessor();
    for (auto at = box.begin(); at; ++at) accessor.setValue(*at, value(out->indexToWorld((*at).asVec3d())));
    return out;
}

Vec3s rotation(const Vec3d& omega, const Vec3d& p) { return Vec3s(omega.cross(p)); }

/// The largest |grid - wanted| over the voxels that are `margin` or more inside the box.
template <class Wanted>
double largest_error(const FloatGrid& grid, const CoordBBox& box, const Wanted& wanted, int margin = 1) {
    auto inner = box;
    inner.expand(-margin);
    double out = 0;
    for (auto at = inner.begin(); at; ++at) out = std::max(out, std::abs(grid.tree().getValue(*at) - wanted(grid.indexToWorld((*at).asVec3d()))));
    return out;
}

FloatGrid::Ptr flat(const std::string& name, const CoordBBox& box, float value) {
    const auto out = sampled<FloatGrid>(box, [=](const Vec3d&) { return value; });
    out->setName(name);
    return out;
}

}  // namespace

TEST_CASE("a rigid rotation has |curl| of twice its angular velocity, whatever the axis") {
    const Vec3d omega = GENERATE(Vec3d(0, 0, 1.5), Vec3d(2, 0, 0), Vec3d(0, -0.5, 0), Vec3d(0.3, -0.4, 1.2));
    const auto velocity = sampled<VectorGrid>(cube, [&](const Vec3d& p) { return rotation(omega, p); });
    const auto energy = vorticity_energy(velocity, 3.0f);
    CHECK(largest_error(*energy, cube, [&](const Vec3d&) { return 3 * 2 * omega.length(); }) < 1e-5);
    CHECK(energy->activeVoxelCount() == cube.volume());
    CHECK(energy->background() == 0);
    CHECK(energy->transform() == velocity->transform());
    CHECK(energy->getName() == "vorticity of sampled");
}

TEST_CASE("a flow without spin has no vorticity") {
    const auto energy = vorticity_energy(sampled<VectorGrid>(cube, [](const Vec3d& p) { return Vec3s(float(p.x()), float(2 * p.y()), float(-3 * p.z())); }), 1);
    CHECK(largest_error(*energy, cube, [](const Vec3d&) { return 0.0; }) < 1e-6);
}

TEST_CASE("a Gaussian vortex shows its known profile, to the second order of the voxel size") {
    // v = swirl exp(-r^2), so curl v = 2 (1 - r^2) exp(-r^2) along z.
    const auto velocity = sampled<VectorGrid>(cube, [](const Vec3d& p) { return Vec3s(rotation({0, 0, 1}, p) * std::exp(-p.x() * p.x() - p.y() * p.y())); });
    const auto wanted = [](const Vec3d& p) {
        const double r2 = p.x() * p.x() + p.y() * p.y();
        return std::abs(2 * (1 - r2) * std::exp(-r2));
    };
    CHECK(largest_error(*vorticity_energy(velocity, 1), cube, wanted) < 2 * voxel * voxel);
}

TEST_CASE("a staggered velocity is collocated before its curl is taken") {
    const Vec3d omega(0.3, -0.4, 1.2);
    const auto staggered = VectorGrid::create();
    staggered->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    staggered->setGridClass(openvdb::GRID_STAGGERED);
    staggered->setName("velocity");
    for (auto at = cube.begin(); at; ++at) {
        Vec3s faces;
        for (int c = 0; c < 3; ++c) {
            auto face = (*at).asVec3d();
            face[c] -= 0.5;
            faces[c] = rotation(omega, face * voxel)[c];
        }
        staggered->tree().setValue(*at, faces);
    }
    const auto centred = collocated(staggered);
    CHECK(centred->getGridClass() == openvdb::GRID_UNKNOWN);
    CHECK(centred->getName() == "velocity");
    CHECK(centred->activeVoxelCount() == cube.volume());
    CHECK(centred->tree().getValue({2, -3, 4}).eq(rotation(omega, Vec3d(2, -3, 4) * voxel), 1e-6f));
    // A rotation's components do not vary along themselves: another check needs one that does.
    for (auto at = cube.begin(); at; ++at) staggered->tree().setValue(*at, Vec3s(float((*at).x() * (*at).x()), float((*at).y()), float(3 * (*at).z())));
    CHECK(collocated(staggered)->tree().getValue({2, -3, 4}) == Vec3s((4 + 9) / 2.0f, -2.5f, 13.5f));
}

TEST_CASE("a velocity that is not staggered is not copied") {
    const auto velocity = VectorGrid::create();
    CHECK(collocated(velocity) == velocity);
}

TEST_CASE("a linear field has its slope as gradient energy, per world unit") {
    const auto field = sampled<FloatGrid>(cube, [](const Vec3d& p) { return float(7 + 2 * p.x() - 3 * p.y() + 6 * p.z()); });
    const auto energy = gradient_energy(*field, 0.5f);
    CHECK(largest_error(*energy, cube, [](const Vec3d&) { return 0.5 * 7; }) < 1e-4);
    CHECK(energy->activeVoxelCount() == cube.volume());
    CHECK(energy->getName() == "gradient of sampled");
}

TEST_CASE("an active tile has energy at its border only, exactly as the same values in voxels") {
    const auto tiles = FloatGrid::create();
    tiles->tree().addTile(1, {0, 0, 0}, 2.0f, true);
    tiles->tree().addTile(2, {128, 0, 0}, 4.0f, true);
    tiles->tree().setValue({4, 4, 8}, 3.0f);
    const auto voxels = tiles->deepCopy();
    voxels->tree().voxelizeActiveTiles();
    const auto sparse = gradient_energy(*tiles, 1);
    const auto dense = gradient_energy(*voxels, 1);
    CHECK(sparse->tree().activeTileCount() == 14 * 14 * 14);
    CHECK(sparse->activeVoxelCount() == dense->activeVoxelCount());
    std::size_t different = 0;
    for (auto value = dense->cbeginValueOn(); value; ++value) different += *value != sparse->tree().getValue(value.getCoord());
    CHECK(different == 0);
}

TEST_CASE("voxels that are no cubes along the axes are refused") {
    const auto field = FloatGrid::create();
    field->setName("density");
    const auto refusal = [&](const openvdb::math::Transform::Ptr& transform) {
        field->setTransform(transform);
        return failure_of([&] { gradient_energy(*field, 1); });
    };
    using openvdb::math::Transform;
    auto transform = Transform::createLinearTransform(0.1);
    transform->postTranslate({3, 4, 5});
    CHECK(refusal(transform) == "");
    transform->postScale({1, 2, 1});
    CHECK(refusal(transform) ==
          "grid 'density' has voxels of 0.1 x 0.2 x 0.1 (ScaleTranslateMap); derivatives need cubes along the world's axes: resample the grid first");
    transform = Transform::createLinearTransform(0.1);
    transform->postRotate(0.3);
    CHECK(refusal(transform) ==
          "grid 'density' has voxels of 0.1 x 0.1 x 0.1 (AffineMap); derivatives need cubes along the world's axes: resample the grid first");
    CHECK(refusal(Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 3.0, 0.1)) ==
          "grid 'density' has voxels of varying shape (NonlinearFrustumMap); derivatives need cubes along the world's axes: resample the grid first");
}

TEST_CASE("a value that is not finite is refused, the lowest voxel named") {
    const auto field = flat("density", cube, 1);
    field->tree().setValue({5, 1, 1}, std::numeric_limits<float>::infinity());
    field->tree().setValue({-3, 2, 1}, std::numeric_limits<float>::quiet_NaN());
    CHECK(failure_of([&] { gradient_energy(*field, 1); }) ==
          "grid 'density' has a value that is not finite (NaN or infinite) at voxel [-3, 2, 1]; repair it where it comes from");
    CHECK(failure_of([&] { active_range(*field); }) ==
          "grid 'density' has a value that is not finite (NaN or infinite) at voxel [-3, 2, 1]; repair it where it comes from");
    CHECK(failure_of([&] {
              combined_energy({{flat("other", cube, 1), 1, {0, 1}}, {field, 1, {0, 1}}});
          }) == "grid 'density' has a value that is not finite (NaN or infinite) at voxel [-3, 2, 1]; repair it where it comes from");

    const auto velocity = sampled<VectorGrid>(cube, [](const Vec3d&) { return Vec3s(0); });
    velocity->tree().setValueOff({10, 0, 0}, Vec3s(0, std::numeric_limits<float>::quiet_NaN(), 0));
    CHECK(failure_of([&] { vorticity_energy(velocity, 1); }) ==
          "grid 'sampled' has a value that is not finite (NaN or infinite) beside voxel [9, 0, 0]; repair it where it comes from");
}

TEST_CASE("an empty grid has an empty energy") {
    CHECK(gradient_energy(*FloatGrid::create(), 1)->empty());
    CHECK(vorticity_energy(VectorGrid::create(), 1)->empty());
    CHECK(combined_energy({{FloatGrid::create(), 1, active_range(*FloatGrid::create())}})->empty());
}

TEST_CASE("the range of a grid is that of its active values, tiles included") {
    const auto grid = FloatGrid::create(-100.0f);
    grid->tree().setValue({1, 2, 3}, 2.0f);
    grid->tree().setValue({1, 2, 4}, 5.0f);
    grid->tree().setValueOff({1, 2, 5}, 50.0f);
    CHECK(active_range(*grid).low == 2);
    CHECK(active_range(*grid).high == 5);
    grid->tree().addTile(1, {64, 0, 0}, 9.0f, true);
    grid->tree().addTile(2, {128, 0, 0}, -8.0f, true);
    CHECK(active_range(*grid).low == -8);
    CHECK(active_range(*grid).high == 9);
}

TEST_CASE("terms are remapped, clamped, weighted and added on the union of their voxels") {
    const auto ramp = sampled<FloatGrid>(cube, [](const Vec3d& p) { return float(p.x()); });
    const auto block = FloatGrid::create();
    block->setTransform(ramp->transform().copy());
    block->tree().addTile(1, {8, 8, 8}, 10.0f, true);
    block->tree().addTile(2, {128, 0, 0}, 30.0f, true);
    const auto energy = combined_energy({{ramp, 2, {-1, 1}}, {block, 3, {0, 20}}});
    const auto at = [&](int x, int y, int z) { return energy->tree().getValue({x, y, z}); };
    CHECK(at(-9, 0, 0) == 0);         // -2.25, clamped
    CHECK(at(2, 0, 0) == 2 * 0.75f);  // 0.5
    CHECK(at(9, 0, 0) == 2);          // 2.25, clamped
    CHECK(at(9, 9, 9) == 2 + 1.5f);
    CHECK(at(9, 9, 15) == 1 + 1.5f);  // the ramp is not active: its background, 0
    CHECK(at(200, 100, 100) == 1 + 3);
    CHECK(at(-20, 0, 0) == 0);
    CHECK(energy->background() == 0);
    CHECK(energy->activeVoxelCount() == cube.volume() + 512 - 8 + 128 * 128 * 128);
    CHECK(energy->tree().activeTileCount() == 1);
}

TEST_CASE("a constant term counts as nothing") {
    const auto energy = combined_energy({{flat("a", cube, 4), 1, {4, 4}}, {flat("b", cube, 1), 1, {0, 2}}});
    CHECK(energy->tree().getValue({0, 0, 0}) == 0.5f);
}

TEST_CASE("terms on different grids are refused, both named") {
    const auto moved = flat("b", cube, 1);
    moved->setTransform(moved->transform().copy());
    moved->transform().postTranslate({0, 0, 1});
    CHECK(failure_of([&] {
              combined_energy({{flat("a", cube, 1), 1, {0, 1}}, {flat("c", cube, 1), 1, {0, 1}}, {moved, 1, {0, 1}}});
          }) ==
          "terms 1 and 3 have different transforms: 'a' (voxels of 0.25 x 0.25 x 0.25, the first at [0, 0, 0]) and "
          "'b' (voxels of 0.25 x 0.25 x 0.25, the first at [0, 0, 1]); resample one onto the other");
}

TEST_CASE("energy.combine finds its ranges over the whole sequence") {
    NodeBench node(energy_combine(), "weights: [1, 4]", {{"terms", 2}});
    REQUIRE(node.faults() == "");
    REQUIRE(node.gathers());
    const auto frame = [](float a, float b) {
        return NodeBench::Inputs{{"terms", {Payload(Ref<FloatGrid>(flat("a", cube, a))), Payload(Ref<FloatGrid>(flat("b", cube, b)))}}};
    };
    node.add(frame(2, 5));
    node.add(frame(6, 3));
    node.add(frame(4, 5));
    node.finish();
    const auto energy_at = [&](const NodeBench::Inputs& inputs) { return node.run(inputs).at("energy").as<FloatGrid>()->tree().getValue({0, 0, 0}); };
    CHECK(energy_at(frame(2, 3)) == 0);
    CHECK(energy_at(frame(3, 4)) == 0.25f + 4 * 0.5f);
    CHECK(energy_at(frame(6, 5)) == 1 + 4);
}

TEST_CASE("energy.combine gathers only what is left automatic") {
    const auto gathers = [](const std::string& yaml) { return NodeBench(energy_combine(), yaml, {{"terms", 2}}).gathers(); };
    CHECK(gathers("{}"));
    CHECK(gathers("range: auto"));
    CHECK(gathers("range: [[0, 1], auto]"));
    CHECK(gathers("range: [auto, auto]"));
    CHECK_FALSE(gathers("range: [0, 1]"));
    CHECK_FALSE(gathers("range: [[0, 1], [2, 5]]"));

    NodeBench node(energy_combine(), "range: [[0, 4], [2, 6]]", {{"terms", 2}});
    const auto energy =
        node.run({{"terms", {Payload(Ref<FloatGrid>(flat("a", cube, 1))), Payload(Ref<FloatGrid>(flat("b", cube, 5)))}}}).at("energy").as<FloatGrid>();
    CHECK(energy->tree().getValue({0, 0, 0}) == 0.25f + 0.75f);
}

TEST_CASE("energy.combine's parameters are checked against its terms") {
    const auto faults = [](const std::string& yaml) { return NodeBench(energy_combine(), yaml, {{"terms", 3}}).faults(); };
    CHECK(faults("weights: [1, 2]") == "weights: states 2 weights for 3 terms; state one per term\n");
    CHECK(faults("range: [auto, [0, 1]]") == "range: states 2 ranges for 3 terms; state one per term\n");
    CHECK(faults("weights: [1, -2, 1]") == "weights must be at least 0, not -2\n");
    CHECK(faults("range: [2, 1]") == "range has its low end 2 above its high end 1\n");
    CHECK(faults("range: wide") == "range wants auto or [low, high], or a list, each auto or [low, high], not 'wide'\n");
    CHECK(faults("range: []") == "range: states 0 ranges for 3 terms; state one per term\n");
}

TEST_CASE("the gain of a single energy scales it and may not be negative") {
    const auto field = sampled<FloatGrid>(cube, [](const Vec3d& p) { return float(p.x()); });
    NodeBench node(energy_gradient(), "gain: 3");
    CHECK(node.run({{"field", {Payload(Ref<FloatGrid>(field))}}}).at("energy").as<FloatGrid>()->tree().getValue({0, 0, 0}) == Approx(3));
    CHECK(NodeBench(energy_gradient(), "gain: -1").faults() == "gain must be at least 0, not -1\n");
    CHECK(NodeBench(energy_vorticity(), "gain: -1").faults() == "gain must be at least 0, not -1\n");
}
