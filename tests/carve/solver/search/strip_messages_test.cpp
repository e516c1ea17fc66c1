#include "carve/solver/search/strip_messages.h"
#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/search/coarse.h"
#include "carve/solver/search/wavefront.h"
#include "tests/support/brute_force.h"
#include "tests/support/searches.h"
#include "tests/support/synthetic_energy.h"

#include <catch2/catch.hpp>

#include <map>
#include <mutex>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

constexpr int reach_of_strip = ColumnMessages::most_entries / 2;

Strip strip_near(const EnergyVolume& energy, const SeamVector& seam, Window window) {
    return {energy, Band::around(seam, reach_of_strip, window)};
}

SeamVector by_messages(const EnergyVolume& energy, SeamVector seam, Window window, int passes) {
    StripMessages(strip_near(energy, seam, window)).improve(seam, passes, false, quiet);
    return seam;
}

/// Gives an energy a field, and steps a price.
void add_random_steps(EnergyVolume& energy, std::mt19937& random) {
    energy.set_step_prices({.rigidity = {0.1f, 0.2f}});
    add_field(energy, 0.5f, [&](auto, auto) { return static_cast<float>(random() % 100) / 50; });
}

double cost_along(const EnergyVolume& energy, const SeamVector& seam) {
    return cost_of(energy, seam);
}

}  // namespace

TEST_CASE("a wavefront visits each column once, after those before it along every dimension") {
    const std::array<std::size_t, 3> size{7, 10, 3};
    std::mutex mutex;
    std::map<std::array<std::size_t, 3>, int> visits;
    in_wavefront(
        size, {3, 2, 2}, [] { return 0; },
        [&](const ColumnBox& box, int) {
            const std::lock_guard lock(mutex);
            for (auto t = box.begin[2]; t < box.end[2]; ++t)
                for (auto k = box.begin[1]; k < box.end[1]; ++k)
                    for (auto lateral = box.begin[0]; lateral < box.end[0]; ++lateral) {
                        const std::array at{lateral, k, t};
                        for (std::size_t d = 0; d < 3; ++d) {
                            auto before = at;
                            if (before[d]-- > 0) CHECK(visits.contains(before));
                        }
                        ++visits[at];
                    }
        },
        [](double) {});
    CHECK(visits.size() == size[0] * size[1] * size[2]);
    for (const auto& [at, times] : visits) CHECK(times == 1);
}

TEST_CASE("in a line of columns messages find the least seam of their strip, whatever steps cost") {
    std::mt19937 random(1);
    for (int n = 0; n < 300; ++n) {
        std::array<int, 3> size{1, 1, 1};
        size[static_cast<std::size_t>(n % 3)] = 2 + static_cast<int>(random() % 9);
        const ColumnGraph graph(size);
        const int width = 2 + static_cast<int>(random() % 10);
        auto energy = random_volume(random, graph, width);
        if (n % 2 == 0) add_random_steps(energy, random);
        const Window window{0, width - 1};
        const auto given = random_seam(random, graph, window);
        const auto strip = strip_near(energy, given, window);
        const auto steps = energy.steps();
        const auto step = [&](std::size_t c, int entry, std::size_t other, int there) {
            return static_cast<double>(steps(c, entry, other, there, size[2] > 1));
        };
        const auto least = brute_force(graph, strip.band(), energies_of(energy), step).cost;
        const auto found = by_messages(energy, given, window, 2);
        INFO("case " << n);
        REQUIRE(is_seam(graph, strip.band(), found));
        REQUIRE(cost_along(energy, found) == Approx(least).epsilon(1e-4));
    }
}

TEST_CASE(
    "messages leave seams feasible, in their strip and no dearer, past protected vertices, in "
    "rings of any length") {
    std::mt19937 random(2);
    constexpr int width = 12;
    const Window window{1, 10};
    int better = 0, cases = 0;
    for (const auto& graph :
         {ColumnGraph({33, 47, 3}), ColumnGraph({9, 31, 40}, true),
          ColumnGraph({49, 8, 26}, false, true), ColumnGraph({26, 25, 24}, true, true),
          ColumnGraph({1, 5, 70}, true), ColumnGraph({2, 2, 9}, true, true),
          ColumnGraph({3, 1, 50}, false, true)})
        for (const bool guarded : {false, true})
            for (const bool stepping : {false, true}) {
                auto energy = random_volume(random, graph, width);
                const auto given = random_seam(random, graph, window);
                for (std::size_t c = 0; guarded && c < given.size(); ++c)
                    for (int entry = 0; entry < width; ++entry)
                        if (entry != given[c] && random() % 8 == 0)
                            energy.codes(
                                c /
                                energy.columns_per_frame())[c % energy.columns_per_frame() * width +
                                                            static_cast<std::size_t>(entry)] =
                                protected_code;
                energy.find_marks();
                if (stepping) add_random_steps(energy, random);
                const auto found =
                    with_threads(1, [&] { return by_messages(energy, given, window, 3); });
                INFO(graph.size[0] << " x " << graph.size[1] << " x " << graph.size[2]
                                   << ", guarded " << guarded << ", steps " << stepping);
                REQUIRE(is_seam(graph, strip_near(energy, given, window).band(), found));
                REQUIRE(cost_along(energy, found) <= cost_along(energy, given));
                CHECK(found ==
                      with_threads(2, [&] { return by_messages(energy, given, window, 3); }));
                ++cases;
                better += found != given ? 1 : 0;
            }
    // Only holes may leave no way that the messages lead to.
    CHECK(better >= cases * 3 / 4);
}

TEST_CASE(
    "many messages come near the cheapest seam of a strip, in volumes, in rings and with steps") {
    std::mt19937 random(3);
    struct Case {
        ColumnGraph graph;
        bool stepping;
        double worse;  ///< in rings the last columns must meet what the first have taken
    };
    for (const auto& [graph, stepping, worse] :
         {Case{ColumnGraph({12, 14, 6}), false, 0.03},
          Case{ColumnGraph({12, 15, 6}, true), false, 0.06},
          Case{ColumnGraph({9, 10, 7}, true, true), false, 0.06},
          Case{ColumnGraph({10, 12, 5}), true, 0.03}}) {
        auto energy = random_volume(random, graph, 12);
        if (stepping) add_random_steps(energy, random);
        const auto given = random_seam(random, graph, {0, 11});
        const auto strip = strip_near(energy, given, {0, 11});
        const auto least = cost_along(energy, cut_seam(energy, strip.band(), 0, 0, quiet).at);
        INFO(graph.size[0] << " x " << graph.size[1] << " x " << graph.size[2] << ", closed "
                           << graph.closed << ", steps " << stepping);
        CHECK(cost_along(energy, by_messages(energy, given, {0, 11}, 60)) <= (1 + worse) * least);
    }
}

TEST_CASE("messages that begin with those at half the resolution lead further in one pass") {
    for (const bool closed : {false, true}) {
        const auto energy = SyntheticEnergy(Synthetic::smoke, 5)({40, 24, 33}, 10, closed);
        const Window window{2, 37};
        const auto coarse = restrict_energy(energy, window, energy.barrier());
        const Window all{0, coarse.width() - 1};
        auto coarse_seam = exact_seam(coarse, all, 0, quiet).at;
        SeamVector at(coarse_seam.begin(), coarse_seam.end());
        StripMessages before(strip_near(coarse, at, all));
        before.improve(at, 8, true, quiet);
        const auto given = prolong_seam(Columns(coarse), at, Columns(energy), window);
        const auto without = by_messages(energy, given, window, 1);
        auto found = given;
        StripMessages(strip_near(energy, given, window), window, before)
            .improve(found, 1, false, quiet);
        INFO("closed " << closed);
        CHECK(cost_along(energy, found) < cost_along(energy, without));
        CHECK(is_seam(ColumnGraph({24, 33, 10}, closed),
                      Band::around(given, reach_of_strip, window), found));
    }
}

TEST_CASE("where all entries cost the same, messages leave a seam where it is") {
    std::mt19937 random(4);
    const ColumnGraph graph({20, 18, 5}, true);
    const auto energy = volume_of(graph, 14, [](std::size_t, int) { return 0.37; });
    const auto given = random_seam(random, graph, {0, 13});
    CHECK(by_messages(energy, given, {0, 13}, 4) == given);
}

TEST_CASE("messages stop when they are told to") {
    std::mt19937 random(5);
    const ColumnGraph graph({20, 18, 5});
    const auto energy = random_volume(random, graph, 9);
    auto seam = random_seam(random, graph, {0, 8});
    StripMessages messages(strip_near(energy, seam, {0, 8}));
    struct Stop {};
    CHECK_THROWS_AS(messages.improve(seam, 2, false, [] { throw Stop{}; }), Stop);
}
