#include "nodes/solving/placement.h"
#include "carve/solver/pyramid.h"
#include "nodes/seam.h"
#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

const Region::Box content{{0, 0, 0}, {1, 1, 1}}, beside{{5, 0, 0}, {6, 2, 1}};
const std::string apart =
    "the lattice misses the data: it lies within (5, 0, 0) to (6, 2, 1), but the files that "
    "`energy` comes from have voxels, by their headers, only from (0, "
    "0, "
    "0) to (1, 1, 1); ";
const std::string nothing =
    "by their headers, the files that `energy` comes from have no active voxels in any frame: "
    "there is nothing to carve; choose another grid under `grids` of "
    "their reader, `fluidcarve inspect` lists them";

}  // namespace

TEST_CASE(
    "a lattice beside the data is told with both places, and with what would bring them together") {
    const Region energy{{content}, {}}, lattice{{beside}, {}};
    CHECK(placement_fault(energy, &energy).empty());
    CHECK(placement_fault(energy, nullptr).empty());
    CHECK(placement_fault(energy, &lattice) ==
          apart +
              "move the lattice (its rig, or `min` and `max`) or the data (`translate` and `scale` "
              "of its reader)");
    const Region curve{
        {beside},
        {{"`axes: z_to_y` in rig.curve", {beside}}, {"`axes: y_to_z` in rig.curve", {content}}}};
    CHECK(placement_fault(energy, &curve) == apart + "with `axes: y_to_z` in rig.curve they meet");
    CHECK(placement_fault({}, &lattice) == nothing);
    CHECK(placement_fault({}, nullptr) == nothing);
}

TEST_CASE("a solver looks where its energy and its lattice lie before a run, if seams are wanted") {
    const auto warnings = [](const std::string& yaml, const NodeBench::Regions& inputs) {
        return NodeBench(seam_pyramid(), yaml).foresee(inputs).warnings;
    };
    const NodeBench::Regions both{{"energy", {{content}, {}}}, {"lattice", {{beside}, {}}}};
    REQUIRE(warnings("{count: -1}", both).size() == 1);
    CHECK(warnings("{count: -1}", both)[0].starts_with(apart));
    CHECK(warnings("{count: 0}", both).empty());
    CHECK(warnings("{count: -1}", {{"lattice", {{beside}, {}}}}).empty());
    CHECK(warnings("{count: -1}", {{"energy", {}}}) == std::vector<std::string>{nothing});
}
