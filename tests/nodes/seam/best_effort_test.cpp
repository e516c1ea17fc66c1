#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "nodes/seam.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

// Fewer seams than asked for: `best_effort`, and counts that would leave nothing.

namespace {

FloatGrid::Ptr flat() {
    return energy_grid(CoordBBox(Coord(0), Coord(7, 2, 3)), [](const Coord&) { return 1.0f; });
}

/// Protects these entries of the column (1, 2) in frame 6.
Grids guarded(int first, int last) {
    std::vector<Coord> wall;
    for (int x = first; x <= last; ++x) wall.emplace_back(x, 1, 2);
    return {{"protect", {mask_grid({}), mask_grid(wall), mask_grid({})}}};
}

Solved run(const std::string& yaml, const Grids& grids = {}, const Otherwise& otherwise = {},
           NodeType (*solver)() = seam_greedy) {
    return solve(solver(), yaml, {flat()}, {box({8, 3, 4})}, grids, 3, {}, otherwise);
}

Otherwise after(const Solved& before) {
    Otherwise out;
    out.before = before.seams;
    out.reported = before.listener.entry;
    return out;
}

void check_same_seams(const std::vector<Seams::Seam>& got, const std::vector<Seams::Seam>& want) {
    REQUIRE(got.size() == want.size());
    for (std::size_t n = 0; n < got.size(); ++n) CHECK(got[n].at == want[n].at);
}

/// A report but for how long it took.
std::string untimed(nlohmann::ordered_json entry) {
    entry.erase("wall_s");
    return entry.dump();
}

const std::string way_closes =
    "in frame 6 column (0 to 7, 1, 2), from (0, 1, 2) to (7, 1, 2), has no unprotected vertex left";
const std::string three_of_five =
    "finds 3 of 5 seams, as many as there is room for in window [0, 7]: " + way_closes;

}  // namespace

TEST_CASE(
    "with best_effort there are as many seams as protection leaves room for, and a warning says "
    "how many of how many") {
    for (auto* const solver : {&seam_greedy, &seam_pyramid, &seam_graph_cut}) {
        const auto some = run("{count: -5, best_effort: true}", guarded(3, 7), {}, solver),
                   three = run("{count: -3}", guarded(3, 7), {}, solver);
        check_same_seams(some.seams->seams, three.seams->seams);
        CHECK(some.listener.warnings == std::vector<std::string>{three_of_five});
        auto entry = some.listener.entry;
        CHECK(entry["asked"] == 5);
        CHECK(entry["no_more"] == "window [0, 7]: " + way_closes);
        entry.erase("asked");
        entry.erase("no_more");
        CHECK(untimed(entry) == untimed(three.listener.entry));
    }
    CHECK(run("{count: 4, best_effort: true}", guarded(3, 7)).listener.warnings ==
          std::vector<std::string>{"finds 3 of 4 seams, as many as there is room for in window [0, "
                                   "7]: in frame 6 column (0 to 6, 1, 2), from (0, 1, 2) to "
                                   "(6, 1, 2), has no unprotected vertex left"});
    const auto all = run("{count: -3, best_effort: true}", guarded(3, 7));
    CHECK(all.listener.warnings.empty());
    CHECK(!all.listener.entry.contains("asked"));
}

TEST_CASE("there are as many pairs as both windows have room for, perhaps none") {
    const std::string windows = ", window: [0, 2], pair_window: [4, 6], best_effort: true}";
    const auto one = run("{count: 2" + windows, guarded(0, 1)),
               asked = run("{count: 1" + windows, guarded(0, 1));
    check_same_seams(one.seams->seams, asked.seams->seams);
    check_same_seams(one.seams->pairs, asked.seams->pairs);
    CHECK(one.seams->pairs.size() == 1);
    CHECK(one.listener.entry["pair_energy"].size() == 1);
    CHECK(one.listener.entry["wall_s"].size() == 1);
    CHECK(one.listener.warnings ==
          std::vector<std::string>{"finds 1 of 2 seams, as many as there is room for in window [0, "
                                   "2]: in frame 6 column (0 to 2, 1, 2), from (0, 1, 2) to "
                                   "(2, 1, 2), has no unprotected vertex left"});
    const auto none = run("{count: 1" + windows, guarded(3, 7));
    CHECK(none.seams->seams.empty());
    CHECK(none.seams->pairs.empty());
    CHECK(
        none.listener.warnings ==
        std::vector<std::string>{"finds 0 of 1 seams, as many as there is room for in pair_window "
                                 "[4, 6]: in frame 6 column (4 to 6, 1, 2), from (4, 1, 2) "
                                 "to (6, 1, 2), has no unprotected vertex left"});
}

TEST_CASE("with best_effort a window that is too small is no failure either") {
    const auto warned = [](const std::string& yaml, std::size_t count, const std::string& warning) {
        const auto solved = run(yaml);
        CHECK(solved.seams->seams.size() == count);
        // Before the search it warns of the energy, which is the same everywhere.
        REQUIRE(solved.listener.warnings.size() == 2);
        CHECK(solved.listener.warnings.back() == warning);
    };
    warned("{count: -9, window: [2, 5], best_effort: true}", 4,
           "finds 4 of 9 seams, as many as there is room for in window [2, 5]: it has room to "
           "remove 4");
    warned("{count: 9, window: [2, 7], best_effort: true}", 5,
           "finds 5 of 9 seams, as many as there is room for in window [2, 7]: it has room to "
           "insert 5");
    warned("{count: -100%, best_effort: true}", 7,
           "finds 7 of 8 seams, as many as there is room for in window [0, 7]: it has room to "
           "remove 7");
    const auto thin =
        solve(seam_greedy(), "{count: -1, best_effort: true}", {flat()}, {box({1, 3, 4})}, {}, 3);
    CHECK(thin.seams->seams.empty());
    CHECK(thin.listener.warnings ==
          std::vector<std::string>{"finds 0 of 1 seams, as many as there is room for in window [0, "
                                   "0]: it has room to remove 0"});
}

TEST_CASE(
    "a set that holds all seams that there are answers every larger count, and smaller ones as if "
    "there were more") {
    const auto growth = *seam_greedy().growth;
    const auto some = run("{count: -5, best_effort: true}", guarded(3, 7)),
               three = run("{count: -3}", guarded(3, 7));
    CHECK(growth.exhausted(some.listener.entry));
    CHECK(!growth.exhausted(three.listener.entry));
    const auto cut_to = [&](std::size_t count) {
        auto entry = some.listener.entry;
        const auto seams = growth.first(Payload(some.seams), count, entry).as<Seams>();
        return std::pair(seams->seams.size(), entry);
    };
    CHECK(cut_to(9).first == 3);
    CHECK(cut_to(9).second["asked"] == 9);
    CHECK(growth.warnings(cut_to(9).second) ==
          std::vector<std::string>{
              "finds 3 of 9 seams, as many as there is room for in window [0, 7]: " + way_closes});
    CHECK(untimed(cut_to(3).second) == untimed(three.listener.entry));
    CHECK(growth.warnings(cut_to(3).second).empty());
    CHECK(cut_to(2).first == 2);
    CHECK(!growth.exhausted(cut_to(2).second));
}

TEST_CASE("a search that goes on from such a set ends as one in one go") {
    const auto some = run("{count: -5, best_effort: true}", guarded(3, 7));
    const auto again = run("{count: -6, best_effort: true}", guarded(3, 7), after(some));
    check_same_seams(again.seams->seams, some.seams->seams);
    CHECK(again.listener.entry["asked"] == 6);
    CHECK(failure_of([&] { run("{count: -5}", guarded(3, 7), after(some)); }) ==
          "3 of 5 seams are possible in window [0, 7]: " + way_closes +
              "; ask for fewer, widen the window or protect less; `best_effort: true` takes as "
              "many as there are (--set NODE.best_effort=true)");
    // Where there is room after all, nothing of the shortfall is left.
    const auto more = run("{count: -5}", {{"protect", {mask_grid({})}}}, after(some));
    CHECK(more.seams->seams.size() == 5);
    CHECK(!more.listener.entry.contains("asked"));
    CHECK(!more.listener.entry.contains("no_more"));
    const auto pair =
        run("{count: 2, window: [0, 2], pair_window: [4, 6], best_effort: true}", guarded(0, 1));
    const auto pair_again =
        run("{count: 2, window: [0, 2], pair_window: [4, 6], best_effort: true}", guarded(0, 1),
            after(pair));
    check_same_seams(pair_again.seams->pairs, pair.seams->pairs);
    CHECK(pair_again.listener.warnings == pair.listener.warnings);
}

TEST_CASE("a count without room fails at the first frame, before anything is solved") {
    const auto told = [](const std::string& yaml, const std::array<int, 3>& shape = {8, 3, 4}) {
        return failure_of([&] {
            NodeBench(seam_pyramid(), yaml)
                .digest({{"energy", {Payload(Ref<FloatGrid>(flat()))}},
                         {"lattice", {Payload(std::make_shared<Lattice>(box(shape)))}}});
        });
    };
    CHECK(told("{count: -8}") == "count -8 removes all 8 vertices along u; at most 7 can go");
    CHECK(told("{count: -100%}") == "count -100% removes all 8 vertices along u; at most 7 can go");
    CHECK(told("{count: -12, window: [0, 7]}") ==
          "count -12 removes more than the 8 vertices along u; at most 7 can go");
    CHECK(told("{count: -4, axis: v}") ==
          "count -4 removes more than the 3 vertices along v; at most 2 can go");
    CHECK(told("{count: -1}", {1, 3, 4}) ==
          "count -1 removes the only vertex along u; none can go");
    CHECK(told("{count: 100%}").starts_with("8 seams do not fit: window [0, 7] has room to "));
    // One may stay alone, a window keeps what is beside it, and insertions take nothing.
    for (const auto* const yaml : {"{count: -7}", "{count: -7, window: [1, 7]}", "{count: 7}",
                                   "{count: -100%, best_effort: true}", "{count: 0}"})
        CHECK(told(yaml) == "");
    CHECK(run("{count: -7}").seams->seams.size() == 7);
    CHECK(run("{count: -7, window: [1, 7]}").seams->seams.size() == 7);
}
