#include "carve/points/point_vectors.h"
#include "nodes/time.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

/// Points that rise by 3 from frame to frame; their velocity is 6.
Ref<Points> rising(double height, std::size_t count) {
    std::vector<Vec3d> at;
    for (std::size_t n = 0; n < count; ++n) at.emplace_back(double(n), 0, height);
    auto table = ply_at(at);
    for (const auto& [name, value] : {std::pair("v_x", 0.0F), {"v_y", 0.0F}, {"v_z", 6.0F}})
        table.columns.push_back(
            column(name, "float", NumberType::float32, std::vector<float>(count, value)));
    Points out;
    out.ply = std::make_shared<PointTable>(std::move(table));
    return std::make_shared<Points>(in_vdb(out));
}

}  // namespace

TEST_CASE("particles that are born after the first frame move all the same") {
    NodeBench bench(time_retime_points(), "{speed: 0.5}");
    REQUIRE(bench.faults() == "");
    Context::Host host;
    const std::vector<int> frames{1, 2, 3}, slow{1, 2, 3, 4, 5};
    for (std::size_t t = 0; t < frames.size(); ++t)
        bench.add({{"source", {Payload(rising(3.0 * double(t), t == 0 ? 0 : 5))}}},
                  Context(host, frames).at(t));
    bench.finish(Context(host, frames));
    const auto shown = [&](std::size_t t) {
        return bench.run({}, Context(host, slow).at(t)).at("points").as<Points>();
    };
    CHECK(shown(0)->size() == 0);
    const auto between = shown(3);
    REQUIRE(between->size() == 5);
    CHECK(between->positions()[2].z() == Approx(4.5));
    CHECK(vectors_of(*between, "v")[2].z() == Approx(3));
    CHECK(shown(4)->positions() == rising(6, 5)->positions());
}
