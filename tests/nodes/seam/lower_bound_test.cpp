#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/bound.h"
#include "carve/solver/task/task_bounds.h"
#include "carve/volume/volume.h"
#include "nodes/seam.h"
#include "tests/support/brute_force.h"
#include "tests/support/scratch.h"
#include "tests/support/searches.h"
#include "tests/support/solver_bench.h"
#include "tests/support/synthetic_energy.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;

TEST_CASE("no seam has less energy than the lower bound, with any number of passes") {
    std::mt19937 random(1);
    for (int n = 0; n < 4000; ++n) {
        const ColumnGraph graph(random_size(random, 12), n % 2 == 0, n % 3 == 0);
        const int width = 1 + static_cast<int>(random() % 6);
        const auto energy = random_volume(random, graph, width, n % 3 == 0 ? 3 : 1024);
        const auto window = random_window(random, width);
        const auto least =
            brute_force(graph, Band::whole(graph.count(), window), energies_of(energy)).cost;
        INFO("case " << n);
        for (const int passes : {0, 1, 3, 20})
            REQUIRE(lower_bound(energy, window, passes, nobody) <= least);
    }
}

TEST_CASE("the bound holds for static seams, in the sums of energies") {
    std::mt19937 random(2);
    for (int n = 0; n < 200; ++n) {
        const auto size = random_size(random, 12);
        const ColumnGraph frame({size[0], size[1], 1}, n % 2 == 0);
        const auto sum =
            random_volume(random, ColumnGraph({size[0], size[1], 4}, n % 2 == 0), 5).sum();
        const auto least =
            brute_force(frame, Band::whole(frame.count(), {0, 4}), energies_of(sum)).cost;
        INFO("case " << n);
        for (const int passes : {0, 10}) REQUIRE(lower_bound(sum, {0, 4}, passes, nobody) <= least);
    }
}

TEST_CASE("for an open line the bound is the least energy but for rounding") {
    std::mt19937 random(3);
    for (int n = 0; n < 200; ++n) {
        std::array<int, 3> size{1, 1, 1};
        size[static_cast<std::size_t>(n % 3)] = 1 + n % 11;
        const ColumnGraph graph(size);
        const auto energy = random_volume(random, graph, 5);
        const auto least =
            brute_force(graph, Band::whole(graph.count(), {1, 4}), energies_of(energy)).cost;
        INFO("case " << n);
        for (const int passes : {0, 2})
            REQUIRE(lower_bound(energy, {1, 4}, passes, nobody) == Approx(least).epsilon(2e-5));
    }
}

TEST_CASE(
    "no seam has less energy than the bound over several blocks of frames, which files hold as "
    "memory does") {
    std::mt19937 random(4);
    for (int n = 0; n < 40; ++n) {
        const ColumnGraph graph({1 + n % 4, 1 + n % 3, 9 + n % 13}, n % 2 == 0, n % 5 == 0);
        const auto energy = random_volume(random, graph, 7);
        const auto least = exact_seam(energy, {0, 6}, 0, [] {}).energy;
        const auto bound = lower_bound(energy, {0, 6}, n % 3, nobody);
        INFO("case " << n << ", least " << least);
        CHECK(bound <= least);
        CHECK(bound >= 0.8 * least);
        const Scratch scratch;
        CHECK(lower_bound(energy, {0, 6}, n % 3, nobody, {0, scratch.path()}) == bound);
    }
}

TEST_CASE(
    "the bound rises with every pass and comes near the least energy, and the number of threads "
    "does not change it") {
    struct Case {
        Synthetic kind;
        bool closed;
        double even, passed;  ///< wanted shares of the least energy, with no pass and with 10
    };
    for (const auto& [kind, closed, even, passed] :
         {Case{Synthetic::smoke, false, 0.78, 0.97}, Case{Synthetic::smoke, true, 0.76, 0.94},
          Case{Synthetic::noise, false, 0.75, 0.94}}) {
        const auto energy = SyntheticEnergy(kind, 5)({24, 12, 16}, 6, closed);
        const double least = exact_seam(energy, {0, 23}, 0, [] {}).energy;
        double before = 0;
        for (const int passes : {0, 1, 2, 5, 10, 20}) {
            const double bound = lower_bound(energy, {0, 23}, passes, nobody);
            INFO(passes << " passes, least " << least);
            CHECK(bound >= before);
            CHECK(bound <= least);
            if (passes == 0) CHECK(bound >= even * least);
            if (passes == 10) CHECK(bound >= passed * least);
            before = bound;
            for (const std::size_t threads : {1, 3}) {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                                threads);
                tbb::task_arena(static_cast<int>(threads)).execute([&] {
                    CHECK(lower_bound(energy, {0, 23}, passes, nobody) == bound);
                });
            }
        }
    }
}

TEST_CASE("the bound comes near the least energy beside protected vertices, too") {
    auto energy = SyntheticEnergy(Synthetic::smoke, 6)({24, 12, 16}, 6);
    // A ball that half of the columns meet.
    for (std::size_t t = 0; t < energy.frames(); ++t)
        for (int k = 0; k < 16; ++k)
            for (int lateral = 0; lateral < 12; ++lateral)
                for (int entry = 0; entry < 24; ++entry)
                    if (std::hypot(entry - 12, lateral - 6, k - 8) < 6)
                        energy.codes(t)[static_cast<std::size_t>(entry + 24 * (lateral + 12 * k))] =
                            protected_code;
    energy.find_marks();
    const double least = exact_seam(energy, {0, 23}, 0, [] {}).energy;
    for (const auto& [passes, share] :
         {std::pair{0, 0.85}, std::pair{1, 0.95}, std::pair{10, 0.99}}) {
        const double bound = lower_bound(energy, {0, 23}, passes, nobody);
        INFO(passes << " passes, least " << least);
        CHECK(bound <= least);
        CHECK(bound >= share * least);
    }
}

TEST_CASE(
    "bounds of one seam after the other are bounds, too, and messages follow what seams delete") {
    std::mt19937 random(7);
    for (int n = 0; n < 100; ++n) {
        const ColumnGraph graph(random_size(random, 12), n % 2 == 0, n % 3 == 0);
        auto energy = random_volume(random, graph, 8);
        ConsecutiveBounds bounds;
        for (int number = 0; number < 6; ++number) {
            const Window window{1, 7 - number};
            INFO("case " << n << ", seam " << number);
            REQUIRE(
                bounds(energy, window, number, n % 2, nobody) <=
                brute_force(graph, Band::whole(graph.count(), window), energies_of(energy)).cost);
            const auto seam = random_seam(random, graph, window);
            bounds.follow(seam, number);
            energy.remove(seam, window);
        }
    }
    // Seams that lie low: above them all entries move.
    auto energy = SyntheticEnergy(Synthetic::smoke, 5)({40, 12, 16}, 6);
    const std::vector<std::uint16_t> low(energy.columns_per_frame() * energy.frames(), 2);
    ConsecutiveBounds following, staying;
    for (int number = 0; number < 5; ++number) {
        const Window window{0, 39 - number};
        const double bound = following(energy, window, number, 0, nobody),
                     stayed = staying(energy, window, number, 0, nobody);
        const double fresh = lower_bound(energy, window, 0, nobody);
        INFO("seam " << number);
        if (number == 0) CHECK(bound == fresh);
        else CHECK(bound > 0.98 * fresh);
        if (number == 3) CHECK(stayed < bound);
        following.follow(low, number);
        energy.remove(low, window);
    }
}

namespace {

/// What a seam costs in the first frames, with its steps.
double cost_within(const ColumnGraph& graph, const EnergyVolume& energy,
                   std::span<const std::uint16_t> seam, std::size_t frames) {
    const auto per_frame = energy.columns_per_frame();
    const auto cost_at = energies_of(energy);
    double out = 0;
    for (std::size_t c = 0; c < frames * per_frame; ++c) {
        out += cost_at(c, seam[c]);
        for (const auto other : graph.neighbours[c])
            if (other < c && seam[other] != seam[c])
                out += static_cast<double>(
                    energy.step_prices().rigidity[other / per_frame == c / per_frame ? 0 : 1]);
    }
    return out;
}

}  // namespace

TEST_CASE(
    "no seam that begins in a given way costs less than the bound for that, after messages in "
    "either direction") {
    std::mt19937 random(8);
    for (int n = 0; n < 60; ++n) {
        const ColumnGraph graph({1 + n % 3, 1 + n % 4, 1 + n % 7}, n % 2 == 0, n % 3 == 0);
        auto energy = random_volume(random, graph, 9);
        if (n % 3 == 1) energy.set_step_prices({.rigidity = {200, 300}});
        const auto per_frame = energy.columns_per_frame();
        ConsecutiveBounds bounds;
        for (int number = 0; number < 4; ++number) {
            const Window window{1, 8 - number};
            bounds(energy, window, number, n % 2, nobody);
            for (int k = 0; k < 20; ++k) {
                const auto seam = random_seam(random, graph, window);
                const double cost = cost_within(graph, energy, seam, energy.frames());
                for (std::size_t t = 0; t < energy.frames(); ++t) {
                    const SeamStart start{t, cost_within(graph, energy, seam, t),
                                          cost_within(graph, energy, seam, t + 1),
                                          seam.data() + t * per_frame, 1};
                    INFO("case " << n << ", seam " << number << ", frame " << t);
                    REQUIRE(bounds.with(start) <= cost);
                }
            }
            const auto gone = random_seam(random, graph, window);
            bounds.follow(gone, number);
            energy.remove(gone, window);
        }
    }
}

TEST_CASE("bounds tell early which seams will cost too much") {
    const ColumnGraph graph({12, 16, 12});
    auto energy = SyntheticEnergy(Synthetic::smoke, 5)({24, 12, 16}, 12);
    ConsecutiveBounds bounds;
    for (int number = 0; number < 2; ++number) {
        const Window window{0, 23 - number};
        bounds(energy, window, number, 3, nobody);
        const auto best = exact_seam(energy, window, number, [] {});
        const auto at = best.at.all();
        const auto start = [&](std::span<const std::uint16_t> seam, std::size_t t) {
            return SeamStart{t, cost_within(graph, energy, seam, t),
                             cost_within(graph, energy, seam, t + 1), seam.data() + t * 192, 1};
        };
        INFO("seam " << number);
        CHECK(bounds.with(start(at, 3)) > 0.9 * best.energy);
        // One that is straight is dear from its first frame on.
        const std::vector<std::uint16_t> straight(graph.count(), 20);
        REQUIRE(cost_within(graph, energy, straight, 12) > 1.5 * best.energy);
        CHECK(bounds.with(start(straight, 6)) > 1.1 * best.energy);
        bounds.follow(at, number);
        energy.remove(at, window);
    }
}

TEST_CASE(
    "solvers find the same seams with bounds as without, and after seams that were found before") {
    const std::array shape{40, 20, 22};
    for (const bool closed : {false, true}) {
        const auto find = [&](SeamBounds* bounds, std::vector<Seams::Seam> before = {}) {
            auto energy = SyntheticEnergy(Synthetic::smoke, 9)(shape, 18, closed);
            SearchOptions continued;
            continued.bounds = bounds;
            continued.before = std::move(before);
            return find_seams(energy, {Seams::Kind::remove, {0, 39}}, 5,
                              Pyramid(Quality::normal, 16), nobody, continued)
                .seams;
        };
        const auto plain = find(nullptr);
        TaskBounds all(std::nullopt, 0, [] {}, {}), rest(std::nullopt, 3, [] {}, {});
        const auto bounded = find(&all),
                   resumed = find(&rest, {bounded.begin(), bounded.begin() + 3});
        for (std::size_t n = 0; n < plain.size(); ++n) {
            INFO("seam " << n << ", closed " << closed);
            CHECK(bounded[n].at == plain[n].at);
            CHECK(bounded[n].energy == plain[n].energy);
            REQUIRE(bounded[n].lower_bound.has_value());
            CHECK(*bounded[n].lower_bound > 0.75 * plain[n].energy);
            CHECK(resumed[n].at == plain[n].at);
            CHECK(resumed[n].lower_bound == bounded[n].lower_bound);
        }
    }
}

TEST_CASE(
    "every seam of a small volume is reported with a bound, of a large one the first, or all if "
    "passes are stated") {
    const auto bounded = [](int frames, const std::string& more) {
        const auto energy =
            energy_grid(openvdb::CoordBBox({0, 0, 0}, {255, 31, 31}), [](const openvdb::Coord& at) {
                return static_cast<float>(1 + (7 * at.x() + 3 * at.y() + 5 * at.z()) % 11);
            });
        const auto solved = solve(seam_greedy(), "{count: -2, starts: 1" + more + "}", {energy},
                                  {box({256, 32, 32})}, {}, static_cast<std::size_t>(frames));
        std::vector<bool> out;
        for (const auto& seam : solved.seams->seams) {
            out.push_back(seam.lower_bound.has_value());
            if (seam.lower_bound) CHECK(*seam.lower_bound <= seam.energy);
        }
        return out;
    };
    CHECK(bounded(2, "") == std::vector{true, true});
    CHECK(bounded(65, "") == std::vector{true, false});
    CHECK(bounded(65, ", bound_passes: 0") == std::vector{true, true});
}
