#include "nodes/seams.h"

#include "tests/support/node_bench.h"
#include "tests/support/seams_through.h"
#include "tests/support/solver_bench.h"
#include "tests/support/warped.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

constexpr std::array size{48, 12, 6};

/// Runs the node on one frame, the same for all. @return the seams, and the report
Solved chosen(const Seams& seams, const std::function<float(const Coord&)>& field) {
    Solved out;
    NodeBench bench(seams_choose());
    const NodeBench::Inputs inputs{
        {"seams", {Payload(std::make_shared<Seams>(seams))}},
        {"field",
         {Payload(energy_grid(CoordBBox(Coord(0), Coord(size[0] - 1, size[1] - 1, size[2] - 1)),
                              field))}},
        {"lattice", {Payload(std::make_shared<Lattice>(box(size)))}}};
    const Context context(out.listener, seams.frames);
    for (std::size_t t = 0; t < seams.frames.size(); ++t)
        bench.add(inputs, Context(out.listener, seams.frames).at(t));
    out.seams = bench.gathered(inputs, context).at("chosen").as<Seams>();
    return out;
}

/// Detail at both ends, and nothing of it between.
float between_detail(const Coord& at) {
    if (at.x() >= 16 && at.x() < 32) return 1;
    return static_cast<float>(static_cast<unsigned>(at.x() * 73 + at.y() * 19 + at.z() * 7) *
                              2654435761u % 100) /
           50;
}

float smooth(const Coord& at) {
    return 1.2f + static_cast<float>(std::sin(2 * M_PI * at.x() / 32));
}

}  // namespace

TEST_CASE("seams between the detail are kept, all of them, removals as well as insertions") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    std::vector<int> entries;
    for (int n = 0; n < 8; ++n) entries.push_back(kind == Seams::Kind::remove ? 20 : 20 + n);
    const auto all =
        chosen(straight_seams(box(size), Axis::u, kind, entries, {1, 2, 3}), between_detail);
    CHECK(all.seams->seams.size() == 8);
    CHECK(all.listener.entry["seams"] == 8);
    CHECK(all.listener.entry["of"] == 8);
    CHECK(all.listener.entry["counts"] == nlohmann::ordered_json({0, 1, 2, 3, 4, 5, 6, 7, 8}));
    CHECK(all.listener.entry["distance"][0] == 1.0);
    CHECK(all.listener.entry["distance"][8].get<double>() < 0.5);
}

TEST_CASE("a bunch of seams in smooth smoke is left to a warp") {
    const auto none = chosen(
        straight_seams(box(size), Axis::u, Seams::Kind::remove, std::vector<int>(8, 20)), smooth);
    CHECK(none.seams->seams.empty());
    CHECK(none.seams->shape_after(0) == box(size).shape);
    CHECK(none.listener.entry["distance"][8].get<double>() > 1.2);
}

TEST_CASE("of few seams each number is compared once, and of none there is nothing to choose") {
    const auto three = chosen(straight_seams(box(size), Axis::u, Seams::Kind::remove, {20, 20, 20}),
                              between_detail);
    CHECK(three.listener.entry["counts"] == nlohmann::ordered_json({0, 1, 2, 3}));
    CHECK(three.seams->seams.size() == 3);
    CHECK(chosen(no_seams(box(size)), between_detail).listener.entry["counts"] ==
          nlohmann::ordered_json::array({0}));
}

TEST_CASE("of slabs whole ones are compared, and of doubled ones as many as a third holds") {
    const auto counts = [](Seams::Kind kind) {
        std::vector<int> entries;
        for (int n = 0; n < 24; ++n) entries.push_back(kind == Seams::Kind::remove ? 12 : 10 + n);
        auto set = straight_seams(box(size), Axis::u, kind, entries);
        set.thickness = 5;
        const auto out = chosen(set, between_detail);
        const auto told = out.listener.entry["counts"].get<std::vector<int>>();
        CHECK(std::ranges::count(told, static_cast<int>(out.seams->seams.size())) == 1);
        return told;
    };
    CHECK(counts(Seams::Kind::insert) == std::vector{0, 5, 10, 15});
    CHECK(counts(Seams::Kind::remove) == std::vector{0, 5, 10, 15, 20, 24});
}

TEST_CASE("of pairs and of a warp no part is chosen, and it is said why") {
    auto pairs = straight_seams(box(size), Axis::u, Seams::Kind::remove, {10});
    pairs.pairs = {straight_seam(pairs, 30)};
    CHECK_THROWS_WITH(chosen(pairs, smooth), Catch::Contains("the seams come in pairs") &&
                                                 Catch::Contains("leave this node out"));
    CHECK_THROWS_WITH(chosen(warped(box(size), evenly(box(size), -3)), smooth),
                      Catch::Contains("is a warp, of which there is nothing to choose"));
}
