#include "nodes/energy.h"
#include "carve/energy/combine.h"
#include "carve/energy/gradient.h"
#include "carve/energy/kinetic.h"
#include "carve/energy/remap.h"
#include "carve/energy/volume.h"
#include "carve/energy/vorticity.h"
#include "carve/field/active_range.h"
#include "carve/field/collocate.h"
#include "formats/vdb/vdb_file.h"
#include "tests/nodes/energy/energy_cases.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"
#include "tests/support/vdb_grid.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;
using test::failure_of;
using test::NodeBench;
using test::rotation;

namespace {

constexpr double voxel = 0.25;

const CoordBBox cube({-9, -9, -9}, {9, 9, 9});

template <class Grid, class Value>
typename Grid::Ptr sampled_in(const CoordBBox& box, const Value& value) {
    return test::sampled<Grid>(box, voxel, value);
}

/// The largest |grid - wanted| over the voxels that are `margin` or more inside the box.
template <class Wanted>
double largest_error(const FloatGrid& grid, const CoordBBox& box, const Wanted& wanted,
                     int margin = 1) {
    auto inner = box;
    inner.expand(-margin);
    double out = 0;
    for (auto at = inner.begin(); at; ++at)
        out = std::max(
            out, std::abs(grid.tree().getValue(*at) - wanted(grid.indexToWorld((*at).asVec3d()))));
    return out;
}

FloatGrid::Ptr flat(const std::string& name, const CoordBBox& box, float value) {
    const auto out = sampled_in<FloatGrid>(box, [=](const Vec3d&) { return value; });
    out->setName(name);
    return out;
}

}  // namespace

TEST_CASE("a rigid rotation has |curl| of twice its angular velocity, whatever the axis") {
    const Vec3d omega =
        GENERATE(Vec3d(0, 0, 1.5), Vec3d(2, 0, 0), Vec3d(0, -0.5, 0), Vec3d(0.3, -0.4, 1.2));
    const auto velocity =
        sampled_in<VectorGrid>(cube, [&](const Vec3d& p) { return rotation(omega, p); });
    const auto energy = vorticity_energy(velocity, 3.0f);
    CHECK(largest_error(*energy, cube, [&](const Vec3d&) { return 3 * 2 * omega.length(); }) <
          1e-5);
    CHECK(energy->activeVoxelCount() == cube.volume());
    CHECK(energy->background() == 0);
    CHECK(energy->transform() == velocity->transform());
    CHECK(energy->getName() == "vorticity of sampled");
}

TEST_CASE("a flow without spin has no vorticity") {
    const auto energy = vorticity_energy(
        sampled_in<VectorGrid>(cube,
                               [](const Vec3d& p) {
                                   return Vec3s(float(p.x()), float(2 * p.y()), float(-3 * p.z()));
                               }),
        1);
    CHECK(largest_error(*energy, cube, [](const Vec3d&) { return 0.0; }) < 1e-6);
}

TEST_CASE("a Gaussian vortex shows its known profile, to the second order of the voxel size") {
    // v = swirl exp(-r^2), so curl v = 2 (1 - r^2) exp(-r^2) along z.
    const auto velocity = sampled_in<VectorGrid>(cube, [](const Vec3d& p) {
        return Vec3s(rotation({0, 0, 1}, p) * std::exp(-p.x() * p.x() - p.y() * p.y()));
    });
    const auto wanted = [](const Vec3d& p) {
        const double r2 = p.x() * p.x() + p.y() * p.y();
        return std::abs(2 * (1 - r2) * std::exp(-r2));
    };
    CHECK(largest_error(*vorticity_energy(velocity, 1), cube, wanted) < 2 * voxel * voxel);
}

TEST_CASE("a staggered velocity is collocated before its curl is taken") {
    const Vec3d omega(0.3, -0.4, 1.2);
    const auto staggered =
        test::sampled_staggered(cube, voxel, [&](const Vec3d& p) { return rotation(omega, p); });
    staggered->setName("velocity");
    const auto centred = collocated(staggered);
    CHECK(centred->getGridClass() == openvdb::GRID_UNKNOWN);
    CHECK(centred->getName() == "velocity");
    CHECK(centred->activeVoxelCount() == cube.volume());
    CHECK(centred->tree().getValue({2, -3, 4}).eq(rotation(omega, Vec3d(2, -3, 4) * voxel), 1e-6f));
    // A rotation's components do not vary along themselves: another check needs one that does.
    for (auto at = cube.begin(); at; ++at)
        staggered->tree().setValue(
            *at, Vec3s(float((*at).x() * (*at).x()), float((*at).y()), float(3 * (*at).z())));
    CHECK(collocated(staggered)->tree().getValue({2, -3, 4}) ==
          Vec3s((4 + 9) / 2.0f, -2.5f, 13.5f));
}

TEST_CASE("a velocity that is not staggered is not copied") {
    const auto velocity = VectorGrid::create();
    CHECK(collocated(velocity) == velocity);
}

TEST_CASE("a linear field has its slope as gradient energy, per world unit") {
    const auto field = sampled_in<FloatGrid>(
        cube, [](const Vec3d& p) { return float(7 + 2 * p.x() - 3 * p.y() + 6 * p.z()); });
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
    for (auto value = dense->cbeginValueOn(); value; ++value)
        different += *value != sparse->tree().getValue(value.getCoord());
    CHECK(different == 0);
}

TEST_CASE("a value that is not finite is refused, the lowest voxel named") {
    const auto field = flat("density", cube, 1);
    field->tree().setValue({5, 1, 1}, std::numeric_limits<float>::infinity());
    field->tree().setValue({-3, 2, 1}, std::numeric_limits<float>::quiet_NaN());
    CHECK(failure_of([&] { gradient_energy(*field, 1); }) ==
          "grid 'density' has a value that is not finite (NaN or infinite) at voxel [-3, 2, 1]; "
          "repair it where it comes from");
    CHECK(failure_of([&] { active_range(*field); }) ==
          "grid 'density' has a value that is not finite (NaN or infinite) at voxel [-3, 2, 1]; "
          "repair it where it comes from");
    CHECK(failure_of([&] {
              combined_energy({{flat("other", cube, 1), 1, {0, 1}}, {field, 1, {0, 1}}});
          }) ==
          "grid 'density' has a value that is not finite (NaN or infinite) at voxel [-3, 2, 1]; "
          "repair it where it comes from");

    const auto velocity = sampled_in<VectorGrid>(cube, [](const Vec3d&) { return Vec3s(0); });
    velocity->tree().setValueOff({10, 0, 0}, Vec3s(0, std::numeric_limits<float>::quiet_NaN(), 0));
    CHECK(failure_of([&] { vorticity_energy(velocity, 1); }) ==
          "grid 'sampled' has a value that is not finite (NaN or infinite) next to voxel [9, 0, "
          "0]; repair it where it comes from");
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
    const auto ramp = sampled_in<FloatGrid>(cube, [](const Vec3d& p) { return float(p.x()); });
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
    CHECK(at(-20, 0, 0) == 1);  // where nothing is active, both backgrounds
    CHECK(energy->background() == 1);
    CHECK(energy->activeVoxelCount() == cube.volume() + 512 - 8 + 128 * 128 * 128);
    CHECK(energy->tree().activeTileCount() == 1);
}

TEST_CASE("a constant term counts as nothing") {
    const auto energy =
        combined_energy({{flat("a", cube, 4), 1, {4, 4}}, {flat("b", cube, 1), 1, {0, 2}}});
    CHECK(energy->tree().getValue({0, 0, 0}) == 0.5f);
}

TEST_CASE("terms on different grids are refused, both named") {
    const auto moved = flat("b", cube, 1);
    moved->setTransform(moved->transform().copy());
    moved->transform().postTranslate({0, 0, 1});
    CHECK(
        failure_of([&] {
            combined_energy({{flat("a", cube, 1), 1, {0, 1}},
                             {flat("c", cube, 1), 1, {0, 1}},
                             {moved, 1, {0, 1}}});
        }) ==
        "terms 1 and 3 have different transforms: 'a' (voxels of 0.25 x 0.25 x 0.25, the first at "
        "[0, 0, 0]) and "
        "'b' (voxels of 0.25 x 0.25 x 0.25, the first at [0, 0, 1]); resample one onto the other");
}

TEST_CASE("energy.combine finds its ranges over the whole sequence") {
    NodeBench node(energy_combine(), "weights: [1, 4]", {{"terms", 2}});
    REQUIRE(node.faults() == "");
    REQUIRE(node.gathers());
    const auto frame = [](float a, float b) {
        return NodeBench::Inputs{{"terms",
                                  {Payload(Ref<FloatGrid>(flat("a", cube, a))),
                                   Payload(Ref<FloatGrid>(flat("b", cube, b)))}}};
    };
    node.add(frame(2, 5));
    node.add(frame(6, 3));
    node.add(frame(4, 5));
    node.finish();
    const auto energy_at = [&](const NodeBench::Inputs& inputs) {
        return node.run(inputs).at("energy").as<FloatGrid>()->tree().getValue({0, 0, 0});
    };
    CHECK(energy_at(frame(2, 3)) == 0);
    CHECK(energy_at(frame(3, 4)) == 0.25f + 4 * 0.5f);
    CHECK(energy_at(frame(6, 5)) == 1 + 4);
}

TEST_CASE("energy.combine gathers only what is left automatic") {
    const auto gathers = [](const std::string& yaml) {
        return NodeBench(energy_combine(), yaml, {{"terms", 2}}).gathers();
    };
    CHECK(gathers("{}"));
    CHECK(gathers("range: auto"));
    CHECK(gathers("range: [[0, 1], auto]"));
    CHECK(gathers("range: [auto, auto]"));
    CHECK_FALSE(gathers("range: [0, 1]"));
    CHECK_FALSE(gathers("range: [[0, 1], [2, 5]]"));

    NodeBench node(energy_combine(), "range: [[0, 4], [2, 6]]", {{"terms", 2}});
    const auto energy = node.run({{"terms",
                                   {Payload(Ref<FloatGrid>(flat("a", cube, 1))),
                                    Payload(Ref<FloatGrid>(flat("b", cube, 5)))}}})
                            .at("energy")
                            .as<FloatGrid>();
    CHECK(energy->tree().getValue({0, 0, 0}) == 0.25f + 0.75f);
}

TEST_CASE("energy.combine's parameters are checked against its terms") {
    const auto faults = [](const std::string& yaml) {
        return NodeBench(energy_combine(), yaml, {{"terms", 3}}).faults();
    };
    CHECK(faults("weights: [1, 2]") ==
          "weights: states 2 weights for 3 terms; state one per term\n");
    CHECK(faults("range: [auto, [0, 1]]") ==
          "range: states 2 ranges for 3 terms; state one per term\n");
    CHECK(faults("weights: [1, -2, 1]") == "weights must be at least 0, not -2\n");
    CHECK(faults("range: [2, 1]") == "range has its low end 2 above its high end 1\n");
    CHECK(faults("range: wide") ==
          "range must be auto or [low, high], or a list, each auto or [low, high], not 'wide'\n");
    CHECK(faults("range: []") == "range: states 0 ranges for 3 terms; state one per term\n");
}

TEST_CASE("the gain of a single energy scales it and may not be negative") {
    const auto field = sampled_in<FloatGrid>(cube, [](const Vec3d& p) { return float(p.x()); });
    NodeBench node(energy_gradient(), "gain: 3");
    CHECK(node.run({{"field", {Payload(Ref<FloatGrid>(field))}}})
              .at("energy")
              .as<FloatGrid>()
              ->tree()
              .getValue({0, 0, 0}) == Approx(3));
    CHECK(NodeBench(energy_gradient(), "gain: -1").faults() == "gain must be at least 0, not -1\n");
    CHECK(NodeBench(energy_vorticity(), "gain: -1").faults() ==
          "gain must be at least 0, not -1\n");
}

TEST_CASE("kinetic energy is the square of the speed, of the collocated velocity") {
    const auto jet =
        sampled_in<VectorGrid>(cube, [](const Vec3d& p) { return Vec3s(2, -3, float(p.x())); });
    const auto energy = kinetic_energy(jet, 2);
    CHECK(largest_error(
              *energy, cube, [](const Vec3d& p) { return 2 * (4 + 9 + p.x() * p.x()); }, 0) < 1e-5);
    CHECK(energy->activeVoxelCount() == cube.volume());
    CHECK(energy->background() == 0);
    CHECK(energy->transform() == jet->transform());
    CHECK(energy->getName() == "kinetic energy of sampled");
    const auto staggered = test::sampled_staggered(
        cube, voxel, [](const Vec3d& p) { return Vec3s(float(p.x()), float(p.y()), 0); });
    CHECK(largest_error(*kinetic_energy(staggered, 1), cube,
                        [](const Vec3d& p) { return p.x() * p.x() + p.y() * p.y(); }) < 1e-5);
}

TEST_CASE("kinetic energy keeps active tiles, whatever the shape of the voxels") {
    const auto velocity = VectorGrid::create();
    velocity->transform().postScale({1, 2, 1});
    velocity->tree().addTile(2, {0, 0, 0}, Vec3s(1, 2, 2), true);
    const auto energy = kinetic_energy(velocity, 1);
    CHECK(energy->tree().activeTileCount() == 1);
    CHECK(energy->tree().leafCount() == 0);
    CHECK(energy->tree().getValue({9, 9, 9}) == 9);
    CHECK(kinetic_energy(VectorGrid::create(), 1)->empty());
}

TEST_CASE("a speed whose square no float holds is refused") {
    const auto velocity = VectorGrid::create();
    velocity->setName("velocity");
    velocity->tree().setValue({1, 2, 3}, Vec3s(1e20f, 0, 0));
    CHECK(failure_of([&] { kinetic_energy(velocity, 1); }) ==
          "grid 'velocity' has values of up to 1e+20, so large that what is computed from them at "
          "voxel [1, 2, 3] has no number: make them smaller with "
          "field.ax");
    velocity->tree().setValue({1, 2, 4}, Vec3s(0, std::numeric_limits<float>::quiet_NaN(), 0));
    CHECK(failure_of([&] { kinetic_energy(velocity, 1); }) ==
          "grid 'velocity' has a value that is not finite (NaN or infinite) at voxel [1, 2, 4]; "
          "repair it where it comes from");
    CHECK(NodeBench(energy_kinetic(), "gain: -1").faults() == "gain must be at least 0, not -1\n");
}

namespace {

/// One frame of the plume: inputs of energy.volume.
struct PlumeFrame {
    Ref<VectorGrid> velocity;
    Ref<FloatGrid> density, temperature;

    explicit PlumeFrame(int frame) {
        const auto path = fmt::format("{}/plume/plume.{:04}.vdb", TEST_DATA, frame);
        velocity = openvdb::gridPtrCast<VectorGrid>(read_vdb_grid(path, "velocity"));
        density = openvdb::gridPtrCast<FloatGrid>(read_vdb_grid(path, "density"));
        temperature = openvdb::gridPtrCast<FloatGrid>(read_vdb_grid(path, "temperature"));
    }
    NodeBench::Inputs inputs() const {
        return {{"velocity", {Payload(velocity)}},
                {"fields", {Payload(density), Payload(temperature)}}};
    }
};

/// The terms of energy.volume, by nodes of their own.
NodeBench::Inputs plume_terms(const PlumeFrame& frame) {
    const NodeBench::Inputs flow{{"velocity", {Payload(frame.velocity)}}};
    const auto gradient = [](const Ref<FloatGrid>& field) {
        return only(NodeBench(energy_gradient()).run({{"field", {Payload(field)}}}));
    };
    return {{"terms",
             {only(NodeBench(energy_vorticity()).run(flow)),
              only(NodeBench(energy_kinetic()).run(flow)), gradient(frame.density),
              gradient(frame.temperature)}}};
}

}  // namespace

TEST_CASE("energy.volume is bit for bit what vorticity, kinetic, gradient and combine nodes give") {
    const auto [volume_yaml, combine_yaml] = GENERATE(
        std::pair("{vorticity: 2, kinetic: 0.5, gradient: 3}", "{weights: [2, 0.5, 3, 3]}"),
        std::pair("{}", "{}"),
        std::pair("{kinetic: 0.25, range: [auto, [0, 4], auto, [0, 0.5]]}",
                  "{weights: [1, 0.25, 1, 1], range: [auto, [0, 4], auto, [0, 0.5]]}"),
        std::pair("{gradient: 2, range: [0, 1]}", "{weights: [1, 1, 2, 2], range: [0, 1]}"));
    NodeBench volume(energy_volume(), volume_yaml, {{"velocity", 1}, {"fields", 2}});
    NodeBench combine(energy_combine(), combine_yaml, {{"terms", 4}});
    REQUIRE(volume.faults() == "");
    REQUIRE(volume.gathers() == combine.gathers());
    const std::vector<PlumeFrame> frames{PlumeFrame(51), PlumeFrame(54), PlumeFrame(56)};
    if (volume.gathers()) {
        for (const auto& frame : frames)
            volume.add(frame.inputs()), combine.add(plume_terms(frame));
        volume.finish();
        combine.finish();
    }
    for (const auto& frame : frames) {
        const auto one = only(volume.run(frame.inputs())).as<FloatGrid>(),
                   other = only(combine.run(plume_terms(frame))).as<FloatGrid>();
        CHECK(test::difference(*one, *other) == "");
        CHECK(one->transform() == frame.velocity->transform());
        CHECK(active_range(*one).high > active_range(*one).low);
    }
}

TEST_CASE("energy.volume takes a velocity alone, and fields alone") {
    const PlumeFrame frame(53);
    NodeBench flow(energy_volume(), "{kinetic: 3, range: [[0, 2], [0, 8]]}", {{"velocity", 1}});
    REQUIRE(flow.faults() == "");
    CHECK(
        test::difference(*only(flow.run({{"velocity", {Payload(frame.velocity)}}})).as<FloatGrid>(),
                         *combined_energy({{vorticity_energy(frame.velocity, 1), 1, {0, 2}},
                                           {kinetic_energy(frame.velocity, 1), 3, {0, 8}}})) == "");
    NodeBench look(energy_volume(), "{gradient: 3, range: [0, 2]}", {{"fields", 1}});
    REQUIRE(look.faults() == "");
    CHECK(test::difference(*only(look.run({{"fields", {Payload(frame.density)}}})).as<FloatGrid>(),
                           *combined_energy({{gradient_energy(*frame.density, 1), 3, {0, 2}}})) ==
          "");
}

TEST_CASE("energy.volume's parameters are checked against its inputs") {
    const auto faults = [](const std::string& yaml,
                           const std::map<std::string, std::size_t>& connected) {
        return NodeBench(energy_volume(), yaml, connected).faults();
    };
    CHECK(faults("{}", {}) == "type: needs 'velocity', 'fields' or both\n");
    CHECK(faults("{kinetic: 2, vorticity: 1, gradient: 1}", {{"fields", 1}}) ==
          "vorticity: 'vorticity' is the weight of a term that needs 'velocity': connect "
          "'velocity', or leave 'vorticity' out\n"
          "kinetic: 'kinetic' is the weight of a term that needs 'velocity': connect 'velocity', "
          "or leave 'kinetic' out\n");
    CHECK(faults("{kinetic: 2, gradient: 1}", {{"velocity", 1}}) ==
          "gradient: 'gradient' is the weight of a term that needs 'fields': connect 'fields', or "
          "leave 'gradient' out\n");
    CHECK(faults("range: [auto, [0, 1]]", {{"velocity", 1}, {"fields", 1}}) ==
          "range: states 2 ranges for 3 terms; state one per term\n");
    CHECK(faults("gradient: -1", {{"fields", 1}}) == "gradient must be at least 0, not -1\n");
}

namespace {

/// 0 to 4 in steps of 1 along x, active from 1 to 4; a tile of 8 beside it.
FloatGrid::Ptr steps() {
    const auto out = FloatGrid::create(0);
    out->setName("steps");
    for (int x = 1; x < 5; ++x) out->tree().setValue({x, 0, 0}, float(x));
    out->tree().addTile(1, {64, 0, 0}, 8.0f, true);
    return out;
}

}  // namespace

TEST_CASE("a remap is straight, clamped, bent and inverted, to the last bit where that is exact") {
    using Values = std::vector<float>;
    const auto remapped = [](const Interval& range, const RemapCurve& curve) {
        return values(*remapped_energy(*steps(), range, curve));
    };
    CHECK(remapped({0, 8}, {}) == Values{0, 0.125f, 0.25f, 0.375f, 0.5f, 1});
    CHECK(remapped({2, 4}, {}) == Values{0, 0, 0, 0.5f, 1, 1});
    CHECK(remapped({2, 4}, {.clamp = false}) == Values{-1, -0.5f, 0, 0.5f, 1, 3});
    CHECK(remapped({0, 4}, {.to = {-2, 6}}) == Values{-2, 0, 2, 4, 6, 6});
    CHECK(remapped({0, 4}, {.gamma = 2}) == Values{0, 0.0625f, 0.25f, 0.5625f, 1, 1});
    CHECK(remapped({0, 4}, {.gamma = 0.5}) ==
          Values{0, 0.5f, std::sqrt(0.5f), float(std::sqrt(0.75)), 1, 1});
    CHECK(remapped({0, 4}, {.invert = true}) == Values{1, 0.75f, 0.5f, 0.25f, 0, 0});
    CHECK(remapped({0, 4}, {.to = {10, 20}, .gamma = 2, .invert = true}) ==
          Values{20, 19.375f, 17.5f, 14.375f, 10, 10});
    CHECK(remapped({0, 4}, {.to = {-2, 6}, .clamp = false, .invert = true}) ==
          Values{6, 4, 2, 0, -2, -10});
    CHECK(remapped({4, 4}, {.to = {3, 5}}) == Values{3, 3, 3, 3, 3, 3});
    CHECK(remapped({4, 4}, {.to = {3, 5}, .clamp = false, .invert = true}) ==
          Values{5, 5, 5, 5, 5, 5});
    CHECK(remapped({0, 4}, {.to = {0.1, 0.7}}).at(4) == 0.7f);
}

TEST_CASE("a remap keeps what is active, tiles as tiles, and remaps the background") {
    const auto in = steps();
    in->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    const auto out = remapped_energy(*in, {0, 8}, {.invert = true});
    CHECK(out->tree().hasSameTopology(in->tree()));
    CHECK(out->background() == 1);
    CHECK(out->transform() == in->transform());
    CHECK(out->getName() == "remap of steps");
    in->tree().setValue({3, 0, 0}, std::numeric_limits<float>::infinity());
    CHECK(failure_of([&] {
              remapped_energy(*in, {0, 8}, {});
          }) ==
          "grid 'steps' has a value that is not finite (NaN or infinite) at voxel [3, 0, 0]; "
          "repair it where it comes from");
}
