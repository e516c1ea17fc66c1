#include "nodes/payloads.h"
#include "nodes/seam/cut/cut_seam.h"
#include "nodes/seam/greedy.h"
#include "nodes/seam/search/bound.h"
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
        const auto least = brute_force(graph, Band::whole(graph.count(), window), energies_of(energy)).cost;
        INFO("case " << n);
        for (const int passes : {0, 1, 3, 20}) REQUIRE(lower_bound(energy, window, passes, nobody) <= least);
    }
}

TEST_CASE("the bound holds for static seams, in the sums of energies") {
    std::mt19937 random(2);
    for (int n = 0; n < 200; ++n) {
        const auto size = random_size(random, 12);
        const ColumnGraph frame({size[0], size[1], 1}, n % 2 == 0);
        const auto sum = random_volume(random, ColumnGraph({size[0], size[1], 4}, n % 2 == 0), 5).sum();
        const auto least = brute_force(frame, Band::whole(frame.count(), {0, 4}), energies_of(sum)).cost;
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
        const auto least = brute_force(graph, Band::whole(graph.count(), {1, 4}), energies_of(energy)).cost;
        INFO("case " << n);
        for (const int passes : {0, 2}) REQUIRE(lower_bound(energy, {1, 4}, passes, nobody) == Approx(least).epsilon(2e-5));
    }
}

TEST_CASE("no seam has less energy than the bound over several blocks of frames, which files hold as memory does") {
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
        CHECK(lower_bound(energy, {0, 6}, n % 3, nobody, 0, scratch.path()) == bound);
    }
}

TEST_CASE("the bound rises with every pass and comes near the least energy, and the number of threads does not change it") {
    struct Case {
        Synthetic kind;
        bool closed;
        double even, passed;  ///< wanted shares of the least energy, with no pass and with 10
    };
    for (const auto& [kind, closed, even, passed] :
         {Case{Synthetic::smoke, false, 0.78, 0.97}, Case{Synthetic::smoke, true, 0.76, 0.94}, Case{Synthetic::noise, false, 0.75, 0.94}}) {
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
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
                tbb::task_arena(static_cast<int>(threads)).execute([&] { CHECK(lower_bound(energy, {0, 23}, passes, nobody) == bound); });
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
                        energy.codes(t)[static_cast<std::size_t>(entry + 24 * (lateral + 12 * k))] = protected_code;
    energy.find_marks();
    const double least = exact_seam(energy, {0, 23}, 0, [] {}).energy;
    for (const auto& [passes, share] : {std::pair{0, 0.85}, std::pair{1, 0.95}, std::pair{10, 0.99}}) {
        const double bound = lower_bound(energy, {0, 23}, passes, nobody);
        INFO(passes << " passes, least " << least);
        CHECK(bound <= least);
        CHECK(bound >= share * least);
    }
}

TEST_CASE("bounds of one seam after the other are bounds, too, and messages follow what seams delete") {
    std::mt19937 random(7);
    for (int n = 0; n < 100; ++n) {
        const ColumnGraph graph(random_size(random, 12), n % 2 == 0, n % 3 == 0);
        auto energy = random_volume(random, graph, 8);
        ConsecutiveBounds bounds;
        for (int number = 0; number < 6; ++number) {
            const Window window{1, 7 - number};
            INFO("case " << n << ", seam " << number);
            REQUIRE(bounds(energy, window, number, n % 2, nobody) <= brute_force(graph, Band::whole(graph.count(), window), energies_of(energy)).cost);
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
        const double bound = following(energy, window, number, 0, nobody), stayed = staying(energy, window, number, 0, nobody);
        const double fresh = lower_bound(energy, window, 0, nobody);
        INFO("seam " << number);
        if (number % 4 == 0) CHECK(bound == fresh);
        else CHECK(bound > 0.98 * fresh);
        if (number == 3) CHECK(stayed < bound);
        following.follow(low, number);
        energy.remove(low, window);
    }
}

TEST_CASE("every seam of a small volume is reported with a bound, of a large one the first, or all if passes are stated") {
    const auto bounded = [](int frames, const std::string& more) {
        const auto energy = energy_grid(openvdb::CoordBBox({0, 0, 0}, {255, 31, 31}),
                                        [](const openvdb::Coord& at) { return static_cast<float>(1 + (7 * at.x() + 3 * at.y() + 5 * at.z()) % 11); });
        const auto solved = solve(seam_greedy(), "{count: -2, starts: 1" + more + "}", {energy}, {box({256, 32, 32})}, {}, static_cast<std::size_t>(frames));
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
