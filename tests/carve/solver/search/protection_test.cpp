#include "carve/solver/search/protection.h"
#include "carve/base/words.h"
#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/dynamic.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/bound.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/strip.h"
#include "carve/volume/volume.h"
#include "tests/support/brute_force.h"
#include "tests/support/reference_carve.h"
#include "tests/support/searches.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

using namespace fluidcarve;
using namespace fluidcarve::test;

// Protected and attracted vertices, against all seams of tiny volumes.

namespace {

/// What a protected vertex costs the oracle: more than all energies of a tiny volume.
constexpr double blocked = 1e9;

std::uint16_t& code_at(EnergyVolume& energy, std::size_t c, int entry) {
    return energy.codes(
        c / energy.columns_per_frame())[c % energy.columns_per_frame() * energy.stride() +
                                        static_cast<std::size_t>(entry)];
}

/// Marks entries at random. @param guarded, wanted  percent of them
void mark(std::mt19937& random, EnergyVolume& energy, int guarded, int wanted) {
    for (std::size_t t = 0; t < energy.frames(); ++t)
        for (auto& code : energy.codes(t)) {
            const int draw = below(random, 100);
            if (draw < guarded) code = protected_code;
            else if (draw < guarded + wanted) code = attracted_code;
        }
    energy.find_marks();
}

/// What the solvers are to make least, from its definition.
CostAt costs_of(EnergyVolume& energy) {
    float highest = 0;
    for (std::size_t t = 0; t < energy.frames(); ++t)
        for (const auto code : energy.codes(t))
            if (code <= highest_energy_code) highest = std::max(highest, decode_energy(code));
    return [&energy, attraction = 64.0 * (highest > 0 ? highest : 1)](std::size_t c,
                                                                      int entry) -> double {
        const auto code = code_at(energy, c, entry);
        return code == protected_code   ? blocked
               : code == attracted_code ? -attraction
                                        : decode_energy(code);
    };
}

/// The energy alone, attracted entries 0.
CostAt plain_energies(EnergyVolume& energy) {
    return [&energy](std::size_t c, int entry) -> double {
        const auto code = code_at(energy, c, entry);
        return code <= highest_energy_code ? decode_energy(code) : 0;
    };
}

/// A volume of few columns, marked, and the best of all its seams.
struct Puzzle {
    ColumnGraph graph;
    int width;
    Window window;
    Band band;
    EnergyVolume energy;
    CostAt cost;
    Least want;

    Puzzle(std::mt19937& random, const std::array<int, 3>& size, bool closed, int guarded,
           int wanted)
        : graph(size, closed),
          width(1 + below(random, 6)),
          window(random_window(random, width)),
          band(Band::whole(graph.count(), window)),
          energy(random_volume(random, graph, width)) {
        mark(random, energy, guarded, wanted);
        cost = costs_of(energy);
        want = brute_force(graph, band, cost);
    }
    bool possible() const { return want.cost < blocked / 2; }
    template <class Entries>
    bool free(const Entries& at) const {
        return is_seam(graph, band, at) && sum(at, cost) < blocked / 2;
    }
    template <class Entries>
    static double sum(const Entries& at, const CostAt& of) {
        double out = 0;
        for (std::size_t c = 0; c < at.size(); ++c) out += of(c, at[c]);
        return out;
    }
};

/// Calls back with puzzles of lines, planes, volumes and sequences, open and closed, that have few
/// free vertices or many.
template <class Call>
void for_puzzles(unsigned seed, int count, int wanted, const Call& call) {
    std::mt19937 random(seed);
    for (int n = 0; n < count; ++n) {
        Puzzle puzzle(random, random_size(random, 12), n % 2 == 0, 10 + below(random, 60),
                      n % 3 == 0 ? wanted : 0);
        INFO("case " << n);
        call(puzzle, n);
    }
}

}  // namespace

TEST_CASE("codes of marks lie above all energies and below what is none") {
    CHECK(highest_energy_code < protected_code);
    CHECK(
        std::set{highest_energy_code, protected_code, attracted_code, invalid_energy_code}.size() ==
        4);
    CHECK(encode_energy(decode_energy(highest_energy_code)) == highest_energy_code);
    CHECK(encode_energy(std::nextafter(decode_energy(protected_code), 0.0f)) ==
          invalid_energy_code);
}

TEST_CASE(
    "exact seams pass no protected vertex, take attracted ones, and cost the least of all that "
    "do") {
    int possible = 0, impossible = 0;
    for_puzzles(1, 6000, 20, [&](Puzzle& puzzle, int n) {
        if (!puzzle.possible()) {
            ++impossible;
            return;
        }
        ++possible;
        const auto seam = exact_seam(puzzle.energy, puzzle.window, n, quiet);
        REQUIRE(seam.at == SeamEntries(n % 2 == 0 ? puzzle.want.highest : puzzle.want.lowest));
        REQUIRE(seam.energy == Puzzle::sum(seam.at, plain_energies(puzzle.energy)));
        REQUIRE(*seam.lower_bound == Approx(seam.energy).margin(1e-6));
        // As small as this is, the pyramid is exact too.
        const auto whole = Pyramid(Quality::normal, 16)(puzzle.energy, puzzle.window, n, nobody);
        REQUIRE(puzzle.free(whole.at));
        REQUIRE(Puzzle::sum(whole.at, puzzle.cost) == puzzle.want.cost);
    });
    CHECK(possible > 1000);
    CHECK(impossible > 500);
}

TEST_CASE("dynamic programming does the same along a line") {
    std::mt19937 random(2);
    int possible = 0;
    for (int n = 0; n < 1000; ++n) {
        std::array<int, 3> size{1, 1, 1};
        size[static_cast<std::size_t>(n % 3)] = 1 + below(random, 10);
        Puzzle puzzle(random, size, n % 2 == 0, 10 + below(random, 40), 20);
        if (!puzzle.possible()) continue;
        ++possible;
        INFO("case " << n);
        const auto seam = DynamicSeams()(puzzle.energy, puzzle.window, n, nobody);
        REQUIRE(puzzle.free(seam.at));
        REQUIRE(Puzzle::sum(seam.at, puzzle.cost) == puzzle.want.cost);
        REQUIRE(seam.energy == Puzzle::sum(seam.at, plain_energies(puzzle.energy)));
    }
    CHECK(possible > 400);
}

TEST_CASE(
    "static seams pass no vertex that is protected in any frame, and add up attraction over the "
    "frames") {
    std::mt19937 random(3);
    int possible = 0;
    for (int n = 0; n < 600; ++n) {
        const auto size = random_size(random, 8);
        const int frames = 2 + below(random, 3), width = 1 + below(random, 6);
        const ColumnGraph all({size[0], size[1], frames}, n % 2 == 0),
            frame({size[0], size[1], 1}, n % 2 == 0);
        auto energy = random_volume(random, all, width);
        mark(random, energy, 5 + below(random, 20), 10);
        const auto each = costs_of(energy), plain = plain_energies(energy);
        const auto over_frames = [&](const CostAt& of) {
            return [&of, &frame, frames](std::size_t c, int entry) {
                double out = 0;
                for (int t = 0; t < frames; ++t)
                    out += of(c + frame.count() * static_cast<std::size_t>(t), entry);
                return out;
            };
        };
        const Window window{0, width - 1};
        const auto band = Band::whole(frame.count(), window);
        const auto want = brute_force(frame, band, over_frames(each));
        INFO("case " << n);
        if (want.cost > blocked / 2) {
            REQUIRE_THROWS_AS(
                find_seams(energy, {Seams::Kind::remove, window, true}, 1, greedy(16), nobody),
                NoSeam);
            continue;
        }
        ++possible;
        const auto sum = energy.sum();
        const auto seam = exact_seam(sum, window, n, quiet);
        REQUIRE(Puzzle::sum(seam.at, over_frames(each)) == Approx(want.cost).epsilon(1e-5));
        REQUIRE(seam.energy == Approx(Puzzle::sum(seam.at, over_frames(plain))));
        const auto quick = greedy_seam(sum, window, n, 16, nobody);
        REQUIRE(is_seam(frame, band, quick.at));
        REQUIRE(Puzzle::sum(quick.at, over_frames(each)) < blocked / 2);
        REQUIRE(quick.energy == Approx(Puzzle::sum(quick.at, over_frames(plain))));
        std::size_t attracted = 0;
        for (std::size_t c = 0; c < all.count(); ++c)
            attracted += code_at(energy, c, quick.at[c % frame.count()]) == attracted_code;
        REQUIRE(sum.met(quick.at).attracted == attracted);
        REQUIRE(sum.met(quick.at).blocked == 0);
    }
    CHECK(possible > 200);
}

TEST_CASE("greedy seams find a way wherever there is one") {
    int possible = 0;
    for_puzzles(4, 12000, 10, [&](Puzzle& puzzle, int n) {
        if (!puzzle.possible()) return;
        ++possible;
        for (const int starts : {1, 16})
            for (const auto guide : {Guide::cone, Guide::gaussian}) {
                const auto seam =
                    greedy_seam(puzzle.energy, puzzle.window, n, starts, nobody, guide);
                REQUIRE(puzzle.free(seam.at));
                REQUIRE(seam.energy == Puzzle::sum(seam.at, plain_energies(puzzle.energy)));
            }
    });
    CHECK(possible > 2000);
}

TEST_CASE("the paper's keyframes find a way too, though each interval knows nothing of the next") {
    int possible = 0;
    for_puzzles(5, 3000, 10, [&](Puzzle& puzzle, int n) {
        if (!puzzle.possible() || puzzle.graph.size[2] == 1) return;
        ++possible;
        const auto seam =
            keyframed_seam(puzzle.energy, puzzle.window, n, 1 + n % 2, n % 4 == 0 ? 2 : 0, quiet);
        REQUIRE(puzzle.free(seam.at));
        REQUIRE(Puzzle::sum(seam.at, puzzle.cost) >= puzzle.want.cost);
    });
    CHECK(possible > 300);
}

TEST_CASE("where there is no seam, that is said, with a column that is to blame") {
    int impossible = 0, emptied = 0;
    for_puzzles(6, 4000, 0, [&](Puzzle& puzzle, int) {
        std::vector<int> free(puzzle.graph.count());
        for (std::size_t c = 0; c < free.size(); ++c)
            for (int entry = puzzle.window.first; entry <= puzzle.window.last; ++entry)
                free[c] += code_at(puzzle.energy, c, entry) != protected_code;
        const bool possible = puzzle.possible();
        try {
            find_seams(puzzle.energy, {Seams::Kind::remove, puzzle.window}, 1, greedy(16), nobody);
            REQUIRE(possible);
        } catch (const NoSeam& none) {
            REQUIRE(!possible);
            ++impossible;
            CHECK(none.found == 0);
            CHECK(none.at.vertices == puzzle.window.size());
            CHECK(none.at.free == free.at(none.at.column));
            const auto first = std::ranges::find(free, 0);
            if (first != free.end())
                CHECK(none.at.column == static_cast<std::size_t>(first - free.begin()));
            else ++emptied;
        }
    });
    CHECK(impossible > 300);
    CHECK(emptied > 50);
}

TEST_CASE("seams run out only where the rest has none") {
    std::mt19937 random(7);
    int all = 0, some = 0;
    for (int n = 0; n < 300; ++n) {
        const ColumnGraph graph({1 + below(random, 3), 1 + below(random, 3), 1 + below(random, 2)},
                                n % 2 == 0);
        auto energy = random_volume(random, graph, 7), left = random_volume(random, graph, 7);
        mark(random, energy, 25, 10);
        for (std::size_t t = 0; t < energy.frames(); ++t)
            std::ranges::copy(energy.codes(t), left.codes(t).begin());
        const auto find = [&](const EnergyVolume& now, Window window, int number, const Tick&) {
            return exact_seam(now, window, number, quiet);
        };
        INFO("case " << n);
        std::vector<Seams::Seam> seams;
        int possible = 4;
        try {
            const auto found = find_seams(energy, {Seams::Kind::remove, {1, 6}}, 4, find, nobody);
            for (std::size_t s = 0; s < 4; ++s) {
                const auto cost = costs_of(left);
                REQUIRE(Puzzle::sum(found.seams[s].at, cost) < blocked / 2);
                REQUIRE(found.blocked[s] == 0);
                std::size_t attracted = 0;
                for (std::size_t c = 0; c < graph.count(); ++c)
                    attracted += cost(c, found.seams[s].at[c]) < 0;
                REQUIRE(found.attracted[s] == attracted);
                left.remove(found.seams[s].at);
            }
            ++all;
        } catch (const NoSeam& none) {
            possible = none.found;
            some += possible > 0;
        }
        if (possible == 4) continue;
        // With as many as are possible, the oracle finds no other in what they leave.
        auto again = random_volume(random, graph, 7);
        for (std::size_t t = 0; t < again.frames(); ++t)
            std::ranges::copy(left.codes(t), again.codes(t).begin());
        again.find_marks();
        const auto found = find_seams(again, {Seams::Kind::remove, {1, 6}}, possible, find, nobody);
        for (const auto& seam : found.seams) left.remove(seam.at);
        REQUIRE(
            brute_force(graph, Band::whole(graph.count(), {1, 6 - possible}), costs_of(left)).cost >
            blocked / 2);
    }
    CHECK(all > 20);
    CHECK(some > 20);
}

TEST_CASE("a seam that passes protected vertices moves to the nearest way below or above") {
    int moved = 0;
    for_puzzles(8, 3000, 0, [&](Puzzle& puzzle, int) {
        if (!puzzle.possible()) return;
        std::mt19937 random(static_cast<unsigned>(puzzle.want.cost));
        const auto seam = random_seam(random, puzzle.graph, puzzle.window);
        const auto got = past_protected(puzzle.energy, puzzle.window, seam);
        REQUIRE(puzzle.free(got));
        if (puzzle.free(seam)) {
            REQUIRE(got == seam);
            return;
        }
        // All seams on one side are the same for an oracle that likes each entry best that is
        // nearest to the seam.
        ++moved;
        const auto nearest = [&](int side) {
            return brute_force(puzzle.graph, puzzle.band, [&](std::size_t c, int entry) {
                if (puzzle.cost(c, entry) > blocked / 2 || (entry - seam[c]) * side < 0)
                    return blocked;
                return static_cast<double>(std::abs(entry - seam[c]));
            });
        };
        const auto low = nearest(-1), high = nearest(1);
        std::vector<double> costs;
        for (const auto& side : {low, high})
            if (side.cost < blocked / 2) {
                costs.push_back(Puzzle::sum(side.lowest, puzzle.cost));
                // Every other entry on this side lies further off.
                REQUIRE(side.lowest == side.highest);
            }
        if (costs.size() == 2)
            REQUIRE(Puzzle::sum(got, puzzle.cost) == std::min(costs[0], costs[1]));
    });
    CHECK(moved > 200);
}

TEST_CASE("bounds hold past protected vertices, and for seams that take as many attracted ones") {
    int possible = 0, bounded = 0;
    for_puzzles(9, 2000, 10, [&](Puzzle& puzzle, int n) {
        if (!puzzle.possible()) return;
        ++possible;
        for (const int passes : {0, 1, 20}) {
            const auto bound = lower_bound(puzzle.energy, puzzle.window, passes, nobody);
            REQUIRE(bound <= puzzle.want.cost);
            const auto seam = greedy_seam(puzzle.energy, puzzle.window, n, 16, nobody);
            const auto energy = energy_bound(puzzle.energy, seam.at, bound);
            REQUIRE(energy >= 0);
            REQUIRE(energy <= seam.energy + 1e-3);
            bounded += energy > 0.5 * seam.energy;
        }
    });
    CHECK(possible > 200);
    CHECK(bounded > 300);
}

namespace {

/// So large that the pyramid does not cut it as a whole; all is protected but a hidden seam and
/// some vertices at random.
EnergyVolume maze(std::mt19937& random, const ColumnGraph& graph, int width, int guarded) {
    const auto hidden = random_seam(random, graph, {width / 4, 3 * width / 4});
    auto out = random_volume(random, graph, width);
    for (std::size_t c = 0; c < graph.count(); ++c)
        for (int entry = 0; entry < width; ++entry)
            if (entry != hidden[c] && below(random, 100) < guarded)
                code_at(out, c, entry) = protected_code;
    out.find_marks();
    return out;
}

}  // namespace

TEST_CASE(
    "the pyramid finds the way through large mazes, as the greedy search does, and never a dearer "
    "one") {
    std::mt19937 random(10);
    for (int n = 0; n < 9; ++n) {
        const ColumnGraph graph(n % 3 == 0   ? std::array{60, 70, 1}
                                : n % 3 == 1 ? std::array{18, 20, 12}
                                             : std::array{1, 201, 21},
                                n % 2 == 0);
        const Window window{2, 67};
        const auto energy =
            maze(random, graph, 70, std::array{30, 70, 99}[static_cast<std::size_t>(n / 3)]);
        REQUIRE(graph.count() * static_cast<std::size_t>(window.size()) > std::size_t{1} << 18);
        const auto band = Band::whole(graph.count(), window);
        const auto quick = greedy_seam(energy, window, n, 16, nobody);
        INFO("case " << n);
        for (const auto quality : {Quality::draft, Quality::normal, Quality::best}) {
            const auto seam = Pyramid(quality, 16)(energy, window, n, nobody);
            for (const auto& found : {quick, seam}) {
                CHECK(is_seam(graph, band, found.at));
                CHECK(energy.met(found.at).blocked == 0);
                CHECK(found.energy == Approx(energy_of(energy, found.at)));
            }
            CHECK(seam.energy <= quick.energy);
        }
    }
}

TEST_CASE(
    "the pyramid takes an attracted ball in as many seams as it is high, in one frame of energies "
    "or their sum") {
    std::mt19937 random(11);
    for (const bool still : {false, true}) {
        const ColumnGraph graph({40, 30, 4});
        auto energy = random_volume(random, graph, 64);
        std::size_t total = 0;
        for (std::size_t c = 0; c < graph.count(); ++c)
            for (int entry = 0; entry < 64; ++entry) {
                const int x = entry - 40, y = static_cast<int>(c % 40) - 17,
                          z = static_cast<int>(c / 40 % 30) - 12;
                if (x * x + y * y + z * z > 16) continue;
                code_at(energy, c, entry) = attracted_code;
                ++total;
            }
        energy.find_marks();
        CHECK(energy.attracted() == total);
        const auto found = find_seams(energy, {Seams::Kind::remove, {0, 63}, still}, 10,
                                      Pyramid(Quality::normal, 16), nobody);
        std::size_t taken = 0;
        for (const auto n : found.attracted) taken += n;
        CHECK(taken == total);
        CHECK(found.attracted_left.back() == 0);
        CHECK(found.attracted[8] > 0);
        CHECK(found.attracted[9] == 0);
    }
}

TEST_CASE("without marks in a volume nothing is protected or attracted") {
    std::mt19937 random(12);
    const ColumnGraph graph({5, 4, 3});
    auto energy = random_volume(random, graph, 9);
    const auto before = greedy_seam(energy, {0, 8}, 0, 16, nobody);
    energy.find_marks();
    CHECK(!energy.protects());
    CHECK(!energy.attracts());
    CHECK(greedy_seam(energy, {0, 8}, 0, 16, nobody).at == before.at);
}
