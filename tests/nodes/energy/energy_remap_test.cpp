#include "carve/energy/combine.h"
#include "carve/energy/gradient.h"
#include "carve/energy/kinetic.h"
#include "carve/energy/remap.h"
#include "carve/energy/volume.h"
#include "carve/energy/vorticity.h"
#include "carve/field/active_range.h"
#include "carve/field/collocate.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/energy.h"
#include "tests/nodes/energy/energy_cases.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;
using test::failure_of;
using test::NodeBench;
using test::rotation;

TEST_CASE("energy.remap finds its range over the whole sequence, unless it is stated") {
    const auto frame = [](float a, float b) {
        auto grid = FloatGrid::create();
        grid->tree().setValue({0, 0, 0}, a);
        grid->tree().setValue({1, 0, 0}, b);
        return NodeBench::Inputs{{"energy", {Payload(Ref<FloatGrid>(grid))}}};
    };
    NodeBench node(energy_remap(), "{to: [0, 100], gamma: 2}");
    REQUIRE(node.faults() == "");
    REQUIRE(node.gathers());
    node.add(frame(2, 3));
    node.add(frame(6, 5));
    node.finish();
    const auto out = only(node.run(frame(4, 6))).as<FloatGrid>();
    CHECK(out->tree().getValue({0, 0, 0}) == 25);
    CHECK(out->tree().getValue({1, 0, 0}) == 100);

    NodeBench stated(energy_remap(), "range: [0, 10]");
    CHECK_FALSE(stated.gathers());
    CHECK(only(stated.run(frame(5, 20))).as<FloatGrid>()->tree().getValue({0, 0, 0}) == 0.5f);
}

TEST_CASE("energy.remap refuses parameters that make no sense") {
    const auto faults = [](const std::string& yaml) {
        return NodeBench(energy_remap(), yaml).faults();
    };
    CHECK(faults("{clamp: false, gamma: 2}") ==
          "gamma: 'gamma' needs clamped values: leave 'gamma' at 1, or 'clamp' at true\n");
    CHECK(faults("{clamp: false, invert: true}") == "");
    CHECK(faults("gamma: 0") == "gamma must be from 0.01 to 100, not 0\n");
    CHECK(faults("to: [1, 0]") == "to has its low end 1 above its high end 0\n");
    CHECK(faults("range: wide") == "range must be [low, high], not 'wide'\n");
}
