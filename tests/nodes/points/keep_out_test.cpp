#include "carve/points/keep_out.h"
#include "nodes/points.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"

#include <openvdb/tools/LevelSetSphere.h>

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

const Vec3d middle(0.3, -0.2, 0.1);
constexpr double voxel = 0.1;

FloatGrid::Ptr ball(double radius) {
    return openvdb::tools::createLevelSetSphere<FloatGrid>(static_cast<float>(radius), middle,
                                                           voxel);
}

struct Listener : Context::Host {
    nlohmann::ordered_json entry;
    std::vector<std::string> warnings;
    void warn(const std::string& message) override { warnings.push_back(message); }
    void report(const std::string& section, const nlohmann::ordered_json& json) override {
        CHECK(section == "points");
        entry = json;
    }
};

}  // namespace

TEST_CASE(
    "points in a solid come to its surface the shortest way, all others stay to the last bit") {
    const auto all = scattered({middle - Vec3d(2), middle + Vec3d(2)}, 20000, 1);
    std::vector<Vec3d> positions;
    // The inmost are out of the band's reach.
    for (const auto& at : all)
        if ((at - middle).length() > 1 - 2 * voxel) positions.push_back(at);
    const auto solid = ball(1);
    for (const auto& points : {points_at(positions), in_vdb(points_at(positions))}) {
        const auto before = points.positions();
        const auto kept = kept_out(points, *solid);
        const auto after = kept.points.positions();
        REQUIRE(after.size() == before.size());
        std::size_t moved = 0;
        const auto ids_before = points.identities(), ids_after = kept.points.identities();
        for (std::size_t n = 0; n < after.size(); ++n) {
            // A grid holds its points voxel by voxel, and one that moves may come to stand
            // elsewhere in its order.
            const auto m = static_cast<std::size_t>(std::ranges::find(ids_before, ids_after[n]) -
                                                    ids_before.begin());
            const auto from = before[m], to = after[n];
            if ((from - middle).length() > 1 + 0.02 * voxel) {
                REQUIRE(to == from);
                continue;
            }
            moved += to != from;
            REQUIRE((to - middle).length() > 1 - 0.02 * voxel);
            REQUIRE((to - middle).length() < 1 + 0.1 * voxel);
            REQUIRE((to - middle).unit().dot((from - middle).unit()) > 0.995);
        }
        CHECK(moved == kept.moved);
        CHECK(moved > 500);
        CHECK(kept.stuck == 0);
    }
}

TEST_CASE(
    "points.keep_out counts, tells of points too deep to know the way out, and wants a level set") {
    const auto run = [](const std::vector<Vec3d>& positions, const FloatGrid::Ptr& solid) {
        Listener listener;
        NodeBench bench(points_keep_out());
        const auto points = std::make_shared<Points>(points_at(positions));
        const auto out = bench
                             .run({{"source", {Payload(points)}}, {"solid", {Payload(solid)}}},
                                  Context(listener, {7}).at(0))
                             .at("points")
                             .as<Points>();
        return std::tuple(listener.entry, listener.warnings, out == points);
    };
    const std::vector<Vec3d> outside{middle + Vec3d(2, 0, 0)};
    CHECK(run(outside, ball(1)) ==
          std::tuple(nlohmann::ordered_json{{"7", {{"points", 1}, {"moved", 0}, {"stuck", 0}}}},
                     std::vector<std::string>(), true));
    CHECK(run({}, ball(1)) ==
          std::tuple(nlohmann::ordered_json{{"7", {{"points", 0}, {"moved", 0}, {"stuck", 0}}}},
                     std::vector<std::string>(), true));
    const auto [entry, warnings, same] = run({middle, middle + Vec3d(0.95, 0, 0)}, ball(1));
    CHECK(entry == nlohmann::ordered_json{{"7", {{"points", 2}, {"moved", 1}, {"stuck", 1}}}});
    CHECK(warnings ==
          std::vector<std::string>{"some points lie so deep in the solid that its distances do not "
                                   "say which way is out, and stay; give it a wider `half_width`"});
    CHECK(!same);
    const auto fog = FloatGrid::create();
    fog->setName("fog");
    CHECK(failure_of([&] { run(outside, fog); }) ==
          "grid 'fog' is no level set and does not say where it is solid; make one, by "
          "sdf.from_mesh for one");
}
