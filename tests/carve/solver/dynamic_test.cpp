#include "carve/solver/dynamic.h"
#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/greedy.h"
#include "carve/volume/volume.h"
#include "tests/support/brute_force.h"
#include "tests/support/failure_of.h"
#include "tests/support/searches.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

/// The least energy of a seam through a line of columns, by the recurrence as it stands in the
/// literature.
double least_energy(const EnergyVolume& energy, std::size_t columns, Window window) {
    std::vector<double> ways(static_cast<std::size_t>(window.size()), 0.0);
    for (std::size_t c = 0; c < columns; ++c) {
        const auto before = ways;
        for (std::size_t i = 0; i < ways.size(); ++i) {
            const auto first = before.begin() + static_cast<std::ptrdiff_t>(i > 0 ? i - 1 : 0),
                       last = before.begin() + static_cast<std::ptrdiff_t>(i + 1);
            ways[i] = *std::min_element(first, last == before.end() ? last : last + 1) +
                      energies_of(energy)(c, window.first + static_cast<int>(i));
        }
    }
    return *std::ranges::min_element(ways);
}

}  // namespace

TEST_CASE(
    "dynamic programming finds the least energy of a line in any dimension, also of a ring, to the "
    "last digit") {
    std::mt19937 random(1);
    for (int n = 0; n < 1500; ++n) {
        std::array<int, 3> size{1, 1, 1};
        size[static_cast<std::size_t>(n % 3)] = 1 + static_cast<int>(random() % 11);
        const ColumnGraph graph(size, n % 2 == 0, n % 4 < 2);
        const int width = 1 + static_cast<int>(random() % 7);
        const auto energy = random_volume(random, graph, width, n % 5 == 0 ? 3 : 1024);
        const auto window = random_window(random, width);
        const auto band = Band::whole(graph.count(), window);
        const auto want = brute_force(graph, band, energies_of(energy));
        const auto seam = DynamicSeams()(energy, window, n, nobody);
        INFO("case " << n);
        REQUIRE(is_seam(graph, band, seam.at));
        REQUIRE(sum_along(seam.at, energies_of(energy)) == want.cost);
        REQUIRE(seam.energy == want.cost);
        REQUIRE(seam.lower_bound == want.cost);
    }
}

TEST_CASE("dynamic programming and the cut agree on images") {
    std::mt19937 random(2);
    for (const bool across : {false, true}) {
        const ColumnGraph graph(across ? std::array{90, 1, 1} : std::array{1, 90, 1});
        const auto energy = random_volume(random, graph, 70);
        const auto seam = DynamicSeams()(energy, {3, 66}, 0, nobody);
        CHECK(is_seam(graph, Band::whole(90, {3, 66}), seam.at));
        CHECK(seam.energy == exact_seam(energy, {3, 66}, 0, [] {}).energy);
        CHECK(seam.energy < greedy_seam(energy, {3, 66}, 0, 16, nobody).energy);
    }
}

TEST_CASE("long lines in windows: of least energy, whatever columns their ways are kept for") {
    std::mt19937 random(4);
    for (int n = 0; n < 60; ++n) {
        const ColumnGraph graph({1 + static_cast<int>(random() % 140), 1, 1});
        const int width = 1 + static_cast<int>(random() % 90);
        const auto energy = random_volume(random, graph, width, n % 3 == 0 ? 3 : 1024);
        const auto window = random_window(random, width);
        const auto seam = DynamicSeams()(energy, window, n, nobody);
        INFO("case " << n);
        REQUIRE(is_seam(graph, Band::whole(graph.count(), window), seam.at));
        REQUIRE(seam.energy == least_energy(energy, graph.count(), window));
        REQUIRE(sum_along(seam.at, energies_of(energy)) == seam.energy);
    }
}

TEST_CASE(
    "wide lines are searched in parts by all threads: of least energy, and the same seam for any "
    "number of threads") {
    std::mt19937 random(6);
    for (const int rigid : {0, 3}) {
        const ColumnGraph graph({203, 1, 1});
        auto energy = random_volume(random, graph, 1301, 1024);
        // Two valleys cross the ends of parts.
        for (int c = 0; c < 203; ++c)
            for (const int entry : {400 + c, 900 - c})
                energy.codes(0)[static_cast<std::size_t>(c) * energy.stride() +
                                static_cast<std::size_t>(entry)] = 0;
        energy.set_step_prices(
            {.rigidity = {static_cast<float>(rigid), static_cast<float>(rigid)}});
        const Window window{2, 1298};
        const auto seam =
            with_threads(1, [&] { return DynamicSeams()(energy, window, 0, nobody); });
        CHECK(is_seam(graph, Band::whole(graph.count(), window), seam.at));
        if (rigid == 0) CHECK(seam.energy == least_energy(energy, graph.count(), window));
        for (const int threads : {2, 3, 5}) {
            const auto other =
                with_threads(threads, [&] { return DynamicSeams()(energy, window, 0, nobody); });
            CHECK(other.at == seam.at);
            CHECK(other.energy == seam.energy);
        }
    }
}

TEST_CASE("static seams of many frames are lines too") {
    std::mt19937 random(3);
    const auto sum = random_volume(random, ColumnGraph({9, 1, 4}), 6).sum();
    const ColumnGraph frame({9, 1, 1});
    CHECK(DynamicSeams()(sum, {0, 5}, 0, nobody).energy ==
          brute_force(frame, Band::whole(9, {0, 5}), energies_of(sum)).cost);
}

TEST_CASE(
    "of equal ways dynamic programming stays, and else leans to one side for even seams, to the "
    "other for odd") {
    const auto flat = volume_of(ColumnGraph({7, 1, 1}), 5, [](std::size_t, int) { return 1.0; });
    for (const int number : {0, 1}) {
        const auto seam = DynamicSeams()(flat, {1, 4}, number, nobody);
        CHECK(std::ranges::all_of(seam.at, [&](auto entry) { return entry == seam.at[0]; }));
    }
    // The last column holds a seam in the middle, and the one before it is dear there.
    const auto fork = volume_of(ColumnGraph({2, 1, 1}), 5, [](std::size_t c, int entry) {
        return c == 1 ? (entry == 2 ? 0.0 : 5.0) : (entry == 2 ? 1.0 : 0.0);
    });
    CHECK(DynamicSeams()(fork, {0, 4}, 0, nobody).at == SeamEntries{1, 2});
    CHECK(DynamicSeams()(fork, {0, 4}, 1, nobody).at == SeamEntries{3, 2});
}

TEST_CASE("volumes are no images: dynamic programming names who takes them") {
    const auto energy = volume_of(ColumnGraph({3, 2, 4}), 5, [](std::size_t, int) { return 1.0; });
    CHECK(failure_of([&] {
              DynamicSeams()(energy, {0, 4}, 0, nobody);
          }) ==
          "seam.dynamic needs columns in one line, as in images, but there are 3 x 2 x 4 columns "
          "(lateral, k, frames); use seam.pyramid or seam.graph_cut");
}

TEST_CASE("seams that begin with what the last one left are those found anew") {
    std::mt19937 random(8);
    for (int n = 0; n < 60; ++n) {
        INFO("case " << n);
        // Ways are kept for every 32nd column and for the last one: in many cases, these two stand
        // side by side.
        const int columns = n % 4 < 2 ? 32 * static_cast<int>(1 + random() % 3) + 2
                                      : 1 + static_cast<int>(random() % 200);
        const int width = 40 + static_cast<int>(random() % 300);
        const ColumnGraph graph(n % 3 == 0 ? std::array{1, 1, columns} : std::array{columns, 1, 1});
        auto energy = random_volume(random, graph, width, n % 4 == 0 ? 3 : 1024);
        energy.set_spread(n % 5, false);
        if (n % 2 == 0) energy.set_step_prices({.rigidity = {2, 3}});
        const bool edges = n % 3 == 1;
        if (edges) {
            add_field(energy, 0.5f, [&](auto, auto) { return random() % 64; });
            energy.count_edges({});
        }
        if (n % 7 == 0) {
            for (std::size_t t = 0; t < energy.frames(); ++t)
                for (auto& code : energy.codes(t))
                    if (random() % 40 == 0)
                        code = random() % 2 == 0 ? protected_code : attracted_code;
            energy.find_marks();
        }
        const Window window{3, width - 4};
        const DynamicSeams consecutive;
        for (int number = 0; number < 30; ++number) {
            const Window left{window.first, window.last - number};
            const auto seam = consecutive(energy, left, number, nobody),
                       anew = DynamicSeams()(energy, left, number, nobody);
            REQUIRE(seam.at == anew.at);
            REQUIRE(seam.energy == anew.energy);
            energy.remove(seam.at, left);
        }
    }
}

TEST_CASE("a search that does not follow the last one begins anew") {
    std::mt19937 random(9);
    const ColumnGraph graph({70, 1, 1});
    auto energy = random_volume(random, graph, 90), other = random_volume(random, graph, 90);
    const DynamicSeams seams;
    const auto same = [&](const EnergyVolume& in, Window window, int number) {
        const auto seam = seams(in, window, number, nobody);
        CHECK(seam.at == DynamicSeams()(in, window, number, nobody).at);
        return seam;
    };
    energy.remove(same(energy, {0, 89}, 0).at, {0, 89});
    same(energy, {0, 88}, 2);
    same(energy, {1, 88}, 3);
    same(other, {1, 89}, 4);
    other.remove(same(other, {0, 89}, 0).at);
    same(other, {0, 88}, 1);
}
