#include "nodes/solving/foreseen.h"
#include "carve/solver/pyramid.h"
#include "nodes/filter.h"
#include "nodes/remap.h"
#include "nodes/seam.h"
#include "nodes/seams.h"
#include "nodes/warp.h"
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
    const auto warnings = [](const NodeBench::Regions& inputs) {
        return NodeBench(seam_pyramid(), "{count: -1}").foresee(inputs).warnings;
    };
    const Region energy{{content}, {}};
    CHECK(warnings({{"energy", energy}, {"lattice", energy}}).empty());
    CHECK(warnings({{"energy", energy}}).empty());
    CHECK(warnings({{"energy", energy}, {"lattice", {{beside}, {}}}}) ==
          std::vector{apart +
                      "move the lattice (its rig, or `min` and `max`) or the data (`translate` "
                      "and `scale` of its reader)"});
    const Region curve{
        {beside},
        {{"`axes: z_to_y` in rig.curve", {beside}}, {"`axes: y_to_z` in rig.curve", {content}}}};
    CHECK(warnings({{"energy", energy}, {"lattice", curve}}) ==
          std::vector{apart + "with `axes: y_to_z` in rig.curve they meet"});
    CHECK(warnings({{"energy", {}}, {"lattice", {{beside}, {}}}}) == std::vector{nothing});
    CHECK(warnings({{"energy", {}}}) == std::vector{nothing});
}

TEST_CASE("where lattice and energy lie plays no part if no seams are wanted") {
    const NodeBench::Regions both{{"energy", {{content}, {}}}, {"lattice", {{beside}, {}}}};
    CHECK(NodeBench(seam_pyramid(), "{count: 0}").foresee(both).warnings.empty());
    CHECK(
        NodeBench(seam_pyramid(), "{count: -1}").foresee({{"lattice", {{beside}, {}}}}).warnings ==
        std::vector<std::string>{});
}

TEST_CASE("solvers say before a run what a lattice of known form has no room for") {
    const auto faults = [](NodeType type, const std::string& yaml, const OutputFacts& lattice,
                           const std::string& other = {}) {
        NodeBench::Received received{{"lattice", {lattice}}};
        if (!other.empty()) received[other] = {{}};
        return NodeBench(std::move(type), yaml).foresee({}, received).faults;
    };
    const std::vector<std::string> none,
        leaves{"window [20, 30] leaves the lattice, which has 24 vertices along u: 0 to 23"};
    const OutputFacts form{{"u", 24}, {"v", 6}};
    CHECK(faults(seam_pyramid(), "{count: -3, window: [20, 30]}", form) == leaves);
    CHECK(faults(warp_solve(), "{amount: -3, window: [20, 30]}", form) == leaves);
    CHECK(faults(seam_pyramid(), "{count: -24}", form).size() == 1);
    CHECK(faults(seam_pyramid(), "{count: -23}", form) == none);
    CHECK(faults(warp_solve(), "{amount: -95%}", form).size() == 1);
    // A percentage of content, a curve, another lattice, and one that others carve are known later.
    CHECK(faults(warp_solve(), "{amount: -95%}", form, "content") == none);
    CHECK(faults(warp_solve(), "{amount: {along: w, at: [[0, 0], [1, -90]]}}", form) == none);
    CHECK(faults(seam_pyramid(), "{count: -99, axis: w}", form) == none);
    CHECK(faults(seam_pyramid(), "{count: -99}", form, "after") == none);
    CHECK(faults(warp_solve(), "{amount: -99}", form, "after") == none);
    CHECK(faults(seam_pyramid(), "{count: -3, axis: v}", {{"u", 24}, {"v", 6}, {"around", 1}}) ==
          std::vector<std::string>{"the lattice goes around its rig, so that v closes and has no "
                                   "end to take from: carve `axis: u`"});
}

TEST_CASE("what a warp does not serve is said before a run") {
    const auto warp = NodeBench(warp_solve(), "{amount: -3}").foresee().facts,
               still = NodeBench(warp_solve(), "{amount: -3, static: true}").foresee().facts,
               seams = NodeBench(seam_pyramid(), "{count: -3}").foresee().facts;
    const auto faults = [](NodeType type, const std::string& yaml, const OutputFacts& first,
                           const OutputFacts& last, bool once = false) {
        return NodeBench(std::move(type), yaml)
            .foresee({}, {{"seams", {first, last}}}, once)
            .faults.size();
    };
    CHECK(faults(filter_seam(), "{}", warp, seams) == 1);
    CHECK(faults(filter_seam(), "{}", seams, seams) == 0);
    CHECK(faults(seams_choose(), "{}", seams, warp) == 1);
    for (const auto& node : {remap_grids(), remap_points(), remap_mesh(), filter_seam()}) {
        INFO(node.name);
        const bool filters = node.name == "filter.seam";
        CHECK(faults(node, "{count: 2}", warp, seams) == (filters ? 1 : 0));
        CHECK(faults(node, "{count: 2}", seams, warp) == 1);
        CHECK(faults(node, "{count: 0}", seams, warp) == (filters ? 1 : 0));
        // A static mesh may be protected from the warp.
        if (filters || node.name == "remap.mesh") continue;
        CHECK(faults(node, "{}", still, seams, true) == 0);
        CHECK(faults(node, "{}", warp, seams, true) == 1);
        CHECK(faults(node, "{}", warp, seams) == 0);
    }
}
