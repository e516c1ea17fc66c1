#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/volume/volume.h"
#include "nodes/seam.h"
#include "nodes/solving/seam_node.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

// `cost: forward`, `rigidity` and `rigidity_time` as the solver nodes take them.

namespace {

constexpr std::size_t frames_solved = 3;

using Frames = std::vector<FloatGrid::Ptr>;

/// Quarters, so that means are exact in 16 bits.
Frames noise_from(std::mt19937& random, const std::array<int, 3>& shape, int least = 0) {
    Frames out;
    for (std::size_t t = 0; t < frames_solved; ++t) {
        out.push_back(FloatGrid::create());
        auto values = out.back()->getAccessor();
        for (auto at = CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)).begin();
             at; ++at)
            values.setValueOn(*at,
                              static_cast<float>(least + static_cast<int>(random() % 256)) / 4);
    }
    return out;
}

struct Given {
    Frames energy, field;
    std::array<int, 3> shape;
};

Solved solve(NodeType solver, const std::string& yaml, const Given& given,
             const std::vector<Ref<Seams>>& after = {}) {
    Grids grids;
    if (!given.field.empty()) grids["field"] = {given.field.begin(), given.field.end()};
    return fluidcarve::test::solve(std::move(solver), yaml, given.energy, {box(given.shape)}, grids,
                                   frames_solved, after);
}

std::string faults(const std::string& yaml, std::size_t fields) {
    return NodeBench(seam_pyramid(), yaml, {{"field", fields}}).faults();
}

}  // namespace

TEST_CASE(
    "forward costs want a field, a field wants forward costs, and neither makes static seams") {
    CHECK(faults("{count: -1, cost: forward}", 1) == "");
    CHECK(faults("{count: -1, rigidity: 2, rigidity_time: 3}", 0) == "");
    CHECK(faults("{count: -1, cost: forward}", 0) ==
          "cost: cost 'forward' needs a `field`, in which it counts the edges that seams leave "
          "behind\n");
    CHECK(faults("{count: -1}", 1) == "");
    CHECK(faults("{count: -1, cost: backward}", 1) ==
          "field: input 'field' serves `cost: forward`, but `cost` is backward: leave one of the "
          "two out\n");
    CHECK(faults("{count: -1, static: true}", 1) ==
          "static: with a `field` the costs of thin seams are counted frame by frame, and no "
          "static ones are found; state a `thickness`, or leave the field "
          "out\n");
    CHECK(faults("{count: -1, field_weight: 2, empty: 1}", 0) ==
          "field_weight: parameter 'field_weight' needs a `field`, in which content and edges are "
          "seen\n"
          "empty: parameter 'empty' needs a `field`, in which content and edges are seen\n");
    CHECK(faults("{count: -1, cost: forward, window: [0, 3], pair_window: [5, 7]}", 1) == "");
    CHECK(faults("{count: -1, cost: forward, window: [0, 3], pair_window: [4, 7]}", 1) ==
          "pair_window: with a `field` there must be a vertex between window and pair_window, "
          "since a seam at the end of one changes the edges of the other\n");
    CHECK(faults("{count: -1, rigidity: -1}", 0) == "rigidity must be at least 0, not -1\n");
}

TEST_CASE("a field that codes do not hold is told with its place") {
    std::mt19937 random(1);
    Given given{noise_from(random, {6, 4, 3}), noise_from(random, {6, 4, 3}), {6, 4, 3}};
    given.field[1]->getAccessor().setValue(Coord(2, 3, 1), 1e6f);
    CHECK_THROWS_WITH(solve(seam_greedy(), "{count: -1, cost: forward}", given),
                      "the field is 1000000 at (2, 3, 1), vertex (2, 3, 1); a solver takes values "
                      "from -65504 to 65504: put it through energy.remap, which "
                      "maps it to 0 to 1");
}

TEST_CASE(
    "with forward costs and rigidity solvers are swapped by their type, and each reports what its "
    "seam pays") {
    std::mt19937 random(2);
    for (const std::string more : {"", ", rigidity: 3, rigidity_time: 5",
                                   ", cost: forward, field_weight: 0.5, rigidity: 1"}) {
        Given given{noise_from(random, {9, 1, 7}), noise_from(random, {9, 1, 7}, -128), {9, 1, 7}};
        if (more.find("forward") == std::string::npos) given.field.clear();
        const auto energy = [&](const NodeType& solver) {
            return solve(solver, "{count: -3" + more + "}", given).listener.entry["energy"];
        };
        const auto exact = energy(seam_graph_cut());
        INFO(more << ": " << exact.dump());
        CHECK(energy(seam_pyramid()) == exact);
        CHECK(energy(seam_greedy())[0] >= exact[0]);
        CHECK(exact[0].get<double>() > 0);
    }
}

TEST_CASE(
    "seams with forward costs go on in what earlier ones left, removed and inserted, along either "
    "axis") {
    std::mt19937 random(3);
    const Given given{
        noise_from(random, {8, 7, 4}), noise_from(random, {8, 7, 4}, -128), {8, 7, 4}};
    const std::string forward = ", cost: forward, rigidity: 0.125}";
    const auto both = solve(seam_graph_cut(), "{count: -2" + forward, given);
    const auto first = solve(seam_graph_cut(), "{count: -1" + forward, given);
    const auto second = solve(seam_graph_cut(), "{count: -1" + forward, given, {first.seams});
    REQUIRE(first.seams->seams[0].at == both.seams->seams[0].at);
    REQUIRE(second.seams->seams[0].at == both.seams->seams[1].at);
    REQUIRE(second.listener.entry["energy"][0] == both.listener.entry["energy"][1]);

    // Beside inserted entries the field is the mean, and the new edges are half as high.
    const auto wider = solve(seam_graph_cut(), "{count: 1" + forward, given);
    Given grown{{}, {}, {9, 7, 4}};
    for (const auto& [from, to] :
         {std::pair(&given.energy, &grown.energy), std::pair(&given.field, &grown.field)})
        for (std::size_t t = 0; t < frames_solved; ++t) {
            auto out = FloatGrid::create();
            auto values = out->getAccessor();
            auto source = (*from)[t]->getConstAccessor();
            for (auto at = CoordBBox(Coord(0), Coord(8, 6, 3)).begin(); at; ++at) {
                const auto column =
                    static_cast<std::size_t>((*at).y() + 7 * ((*at).z() + 4 * static_cast<int>(t)));
                const int doubled = wider.seams->seams[0].at[column], i = (*at).x();
                const auto value = [&](int entry) {
                    return source.getValue(Coord(entry, (*at).y(), (*at).z()));
                };
                values.setValueOn(*at, i <= doubled       ? value(i)
                                       : i == doubled + 1 ? 0.5f * (value(i - 1) + value(i))
                                                          : value(i - 1));
            }
            to->push_back(out);
        }
    CHECK(
        solve(seam_graph_cut(), "{count: -1" + forward, given, {wider.seams}).seams->seams[0].at ==
        solve(seam_graph_cut(), "{count: -1" + forward, grown).seams->seams[0].at);

    // Along v the columns are others.
    const auto along_v = solve(seam_graph_cut(), "{axis: v, count: -1" + forward, given);
    const auto pyramid = solve(seam_pyramid(), "{axis: v, count: -1" + forward, given);
    CHECK(along_v.listener.entry["energy"] == pyramid.listener.entry["energy"]);
    CHECK(along_v.seams->seams[0].at.size() == 8 * 4 * 3);
}

TEST_CASE(
    "with forward costs, the seams of a pair are each found as if the other window were not "
    "there") {
    std::mt19937 random(5);
    const Given given{
        noise_from(random, {12, 4, 3}), noise_from(random, {12, 4, 3}, -128), {12, 4, 3}};
    for (const std::string count : {"-2", "2"}) {
        const auto opposite = count == "2" ? "-2" : "2";
        const auto pair = solve(
            seam_graph_cut(),
            "{cost: forward, rigidity: 0.5, window: [1, 5], pair_window: [7, 10], count: " + count +
                "}",
            given);
        const auto low =
            solve(seam_graph_cut(),
                  "{cost: forward, rigidity: 0.5, window: [1, 5], count: " + count + "}", given);
        const auto high = solve(
            seam_graph_cut(),
            std::string("{cost: forward, rigidity: 0.5, window: [7, 10], count: ") + opposite + "}",
            given);
        CHECK(pair.listener.entry["energy"] == low.listener.entry["energy"]);
        CHECK(pair.listener.entry["pair_energy"] == high.listener.entry["energy"]);
        CHECK(pair.seams->seams[0].at == low.seams->seams[0].at);
        CHECK(pair.seams->pairs[0].at == high.seams->seams[0].at);
    }
}

TEST_CASE("forward seams pass no protected vertex") {
    std::mt19937 random(6);
    const Given given{
        noise_from(random, {9, 5, 4}), noise_from(random, {9, 5, 4}, -128), {9, 5, 4}};
    std::vector<Coord> wall;
    for (int x = 0; x < 9; ++x)
        if (x % 4 != 2) wall.emplace_back(x, 2, 1);
    for (const auto& solver : {seam_graph_cut(), seam_pyramid(), seam_greedy()}) {
        const auto solved = fluidcarve::test::solve(
            solver, "{count: -2, cost: forward, rigidity: 2}", given.energy, {box(given.shape)},
            {{"field", {given.field.begin(), given.field.end()}}, {"protect", {mask_grid(wall)}}},
            frames_solved);
        CHECK(solved.listener.entry["protected"] == nlohmann::ordered_json({0, 0}));
        CHECK(solved.listener.warnings.empty());
    }
}

TEST_CASE("forward seams avoid the edges that backward ones make") {
    std::mt19937 random(4);
    Given given{noise_from(random, {12, 6, 5}), noise_from(random, {12, 6, 5}), {12, 6, 5}};
    const auto edges = [&](const Ref<Seams>& seams) {
        double out = 0;
        const auto& at = seams->seams[0].at;
        for (std::size_t c = 0; c < at.size(); ++c) {
            auto values = given.field[c / 30]->getConstAccessor();
            const auto y = static_cast<int>(c % 6), z = static_cast<int>(c / 6 % 5);
            const auto after = [&](int entry, int row, std::size_t column) {
                return values.getValue(Coord(entry < at[column] ? entry : entry + 1, row, z));
            };
            if (at[c] > 0 && at[c] < 11)
                out += std::abs(after(at[c], y, c) - after(at[c] - 1, y, c));
            if (y == 0) continue;
            for (int entry = 0; entry < 11; ++entry)
                if ((entry < at[c]) != (entry < at[c - 1]))
                    out += std::abs(after(entry, y, c) - after(entry, y - 1, c - 1));
        }
        return out;
    };
    const auto forward = solve(
        seam_graph_cut(), "{count: -1, cost: forward, field_weight: 4, window: [1, 10]}", given);
    Given plain = given;
    plain.field.clear();
    CHECK(edges(forward.seams) <
          0.9 * edges(solve(seam_graph_cut(), "{count: -1, window: [1, 10]}", plain).seams));
}
