#include "carve/solver/cut/cut.h"
#include "carve/solver/cut/cut_seam.h"
#include "carve/volume/volume.h"
#include "nodes/seam.h"
#include "tests/support/brute_force.h"
#include "tests/support/node_bench.h"
#include "tests/support/searches.h"
#include "tests/support/synthetic_energy.h"

#include <tbb/global_control.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <catch2/catch.hpp>

#include <atomic>
#include <thread>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

Cut::CostOf whole_costs(const CostAt& cost) {
    return [&cost](std::size_t c, Band::Column band, std::int32_t* costs) {
        for (int entry = band.first; entry <= band.last; ++entry)
            *costs++ = static_cast<std::int32_t>(cost(c, entry));
    };
}

/// Whole costs at random for the entries of a volume.
struct RandomCosts {
    int width;
    std::vector<double> costs;
    RandomCosts(std::mt19937& random, const ColumnGraph& graph, int width, unsigned most)
        : width(width) {
        for (std::size_t n = 0; n < graph.count() * static_cast<std::size_t>(width); ++n)
            costs.push_back(random() % (most + 1));
    }
    double operator()(std::size_t c, int entry) const {
        return costs[c * static_cast<std::size_t>(width) + static_cast<std::size_t>(entry)];
    }
};

/// The least cost along a line of columns, by dynamic programming.
double least_of_line(std::size_t length, int width, const CostAt& cost) {
    std::vector<double> before(static_cast<std::size_t>(width), 0.0), now = before;
    for (std::size_t c = 0; c < length; ++c) {
        for (std::size_t i = 0; i < now.size(); ++i) {
            const auto first = before.begin() + static_cast<std::ptrdiff_t>(i == 0 ? 0 : i - 1);
            now[i] = cost(c, static_cast<int>(i)) +
                     *std::min_element(first, before.begin() + static_cast<std::ptrdiff_t>(
                                                                   std::min(i + 2, now.size())));
        }
        std::swap(before, now);
    }
    return *std::ranges::min_element(before);
}

}  // namespace

TEST_CASE(
    "a cut finds the least cost of all seams in a band, and of equal seams the highest, or "
    "reversed the lowest") {
    std::mt19937 random(1);
    for (int n = 0; n < 6000; ++n) {
        const ColumnGraph graph(random_size(random, 12), n % 2 == 0, n % 3 == 0);
        const int width = 1 + static_cast<int>(random() % 6);
        // From many ties to the dearest that there may be.
        const RandomCosts costs(random, graph, width,
                                n % 3 == 0   ? 2
                                : n % 3 == 1 ? 100
                                             : Cut::most_cost);
        const CostAt cost = std::cref(costs);
        const auto band = n % 5 == 0 ? Band::whole(graph.count(), {0, width - 1})
                                     : random_band(random, graph, {0, width - 1});
        const auto want = brute_force(graph, band, cost);
        INFO("case " << n);
        for (const bool reversed : {false, true}) {
            Cut cut(columns_of(graph), band, whole_costs(cost), nullptr, reversed);
            REQUIRE(cut.solve(0, quiet));
            REQUIRE(cut.seam() == (reversed ? want.lowest : want.highest));
            REQUIRE(cut.flow() == static_cast<std::int64_t>(want.cost));
            REQUIRE(cut.cost() == cut.flow());
        }
    }
}

TEST_CASE("a cut with a tolerance keeps to it, and its flow is a bound") {
    std::mt19937 random(2);
    int stopped_early = 0;
    for (int n = 0; n < 500; ++n) {
        const ColumnGraph graph(random_size(random, 14), n % 2 == 0, n % 3 == 0);
        const int width = 2 + static_cast<int>(random() % 5);
        const RandomCosts costs(random, graph, width, 1000);
        const CostAt cost = std::cref(costs);
        const auto band = random_band(random, graph, {0, width - 1});
        const auto least = brute_force(graph, band, cost).cost;
        const double tolerance = n % 2 == 0 ? 0.02 : 0.2;
        Cut cut(columns_of(graph), band, whole_costs(cost));
        REQUIRE(cut.solve(tolerance, quiet));
        const auto seam = cut.seam();
        INFO("case " << n);
        REQUIRE(is_seam(graph, band, seam));
        REQUIRE(sum_along(seam, cost) == static_cast<double>(cut.cost()));
        REQUIRE(static_cast<double>(cut.flow()) <= least);
        REQUIRE(static_cast<double>(cut.cost()) <=
                (1 + tolerance) * static_cast<double>(cut.flow()));
        stopped_early += cut.cost() > cut.flow();
    }
    CHECK(stopped_early > 0);
}

TEST_CASE("no seam goes through an endless entry if it can go elsewhere") {
    std::mt19937 random(3);
    int possible = 0;
    for (int n = 0; n < 1000; ++n) {
        const ColumnGraph graph(random_size(random, 10), n % 2 == 0, n % 3 == 0);
        const int width = 3 + static_cast<int>(random() % 4);
        RandomCosts costs(random, graph, width, n % 2 == 0 ? 5 : Cut::most_cost);
        for (std::size_t i = 0; i < costs.costs.size(); ++i) {
            const auto entry = i % static_cast<std::size_t>(width);
            const bool end = entry == 0 || entry + 1 == static_cast<std::size_t>(width);
            if (!end && random() % 3 == 0) costs.costs[i] = Cut::endless;
        }
        const CostAt cost = std::cref(costs);
        const auto band = Band::whole(graph.count(), {0, width - 1});
        const auto want = brute_force(graph, band, cost);
        if (want.cost >= Cut::endless) continue;
        ++possible;
        INFO("case " << n);
        for (const bool reversed : {false, true}) {
            Cut cut(columns_of(graph), band, whole_costs(cost), nullptr, reversed);
            REQUIRE(cut.solve(0, quiet));
            REQUIRE(cut.seam() == (reversed ? want.lowest : want.highest));
            REQUIRE(cut.flow() == static_cast<std::int64_t>(want.cost));
        }
    }
    CHECK(possible > 100);
}

TEST_CASE("cuts of energies are exact to the last digit in any window and band, and say so") {
    std::mt19937 random(4);
    for (int n = 0; n < 4000; ++n) {
        const ColumnGraph graph(random_size(random, 14), n % 2 == 0, n % 3 == 0);
        const int width = 1 + static_cast<int>(random() % 7),
                  number = static_cast<int>(random() % 2);
        const auto energy = random_volume(random, graph, width, n % 4 == 0 ? 3 : 1024);
        const auto window = random_window(random, width);
        const auto whole = Band::whole(graph.count(), window);
        const auto want = brute_force(graph, whole, energies_of(energy));
        const auto exact = exact_seam(energy, window, number, quiet);
        INFO("case " << n);
        REQUIRE(exact.at == SeamEntries(number == 0 ? want.highest : want.lowest));
        REQUIRE(exact.energy == want.cost);
        REQUIRE(exact.lower_bound == want.cost);

        const auto band = random_band(random, graph, window);
        const auto in_band = brute_force(graph, band, energies_of(energy));
        const auto cut = cut_seam(energy, band, 0, number, quiet);
        REQUIRE(cut.at == (number == 0 ? in_band.highest : in_band.lowest));
        REQUIRE(cut.lower_bound == in_band.cost);

        // Beside a seam, as far as the strip reaches.
        const auto seam = random_seam(random, graph, window);
        const int radius = 1 + n % 3;
        const Strip strip(energy, Band::around(seam, 2, window));
        Band near;
        for (std::size_t c = 0; c < seam.size(); ++c)
            near.columns.push_back(
                {static_cast<std::uint16_t>(std::max<int>(seam[c] - radius, strip[c].first)),
                 static_cast<std::uint16_t>(std::min<int>(seam[c] + radius, strip[c].last))});
        const auto beside = cut_seam(strip, seam, radius, 0, number, quiet);
        REQUIRE(is_seam(graph, near, beside.at));
        REQUIRE(beside.lower_bound == brute_force(graph, near, energies_of(energy)).cost);
        REQUIRE(strip.energy(beside.at) == beside.lower_bound);
    }
}

TEST_CASE("static seams are cut exactly in the sums of energies") {
    std::mt19937 random(5);
    for (int n = 0; n < 300; ++n) {
        auto size = random_size(random, 12);
        const ColumnGraph frame({size[0], size[1], 1}, n % 2 == 0),
            all({size[0], size[1], 5}, n % 2 == 0);
        const int width = 2 + static_cast<int>(random() % 5);
        const auto sum = random_volume(random, all, width).sum();
        const auto want =
            brute_force(frame, Band::whole(frame.count(), {0, width - 1}), energies_of(sum));
        const auto exact = exact_seam(sum, {0, width - 1}, 0, quiet);
        INFO("case " << n);
        REQUIRE(exact.at == SeamEntries(want.highest));
        REQUIRE(exact.energy == want.cost);
        REQUIRE(exact.lower_bound == want.cost);
    }
}

TEST_CASE("on flat energy exact seams are straight") {
    for (const bool closed : {false, true}) {
        const ColumnGraph graph({6, 5, 4}, closed);
        const auto energy = volume_of(graph, 9, [](std::size_t, int) { return 2.0; });
        for (const int number : {0, 1}) {
            const auto seam = exact_seam(energy, {2, 7}, number, quiet);
            CHECK(seam.at == SeamEntries(SeamVector(120, number == 0 ? 7 : 2)));
            CHECK(seam.energy == 240);
        }
    }
}

TEST_CASE("energies of very different size, and none at all, are cut") {
    const ColumnGraph graph({3, 2, 2});
    std::mt19937 random(6);
    for (int n = 0; n < 200; ++n) {
        const auto energy = volume_of(graph, 4, [&](std::size_t, int) {
            return n == 0 ? 0.0
                          : std::ldexp(1 + static_cast<double>(random() % 1000) / 1024,
                                       static_cast<int>(random() % 60) - 30);
        });
        const auto want = brute_force(graph, Band::whole(12, {0, 3}), energies_of(energy));
        const auto exact = exact_seam(energy, {0, 3}, 0, quiet);
        INFO("case " << n);
        // What does not fit into 24 bits of the dearest is rounded.
        double dearest = 0;
        for (std::size_t c = 0; c < 12; ++c)
            for (int entry = 0; entry < 4; ++entry)
                dearest = std::max(dearest, energies_of(energy)(c, entry));
        const double rounding = 12 * std::ldexp(dearest, -23);
        CHECK(exact.energy <= want.cost + rounding);
        CHECK(*exact.lower_bound <= want.cost);
        CHECK(*exact.lower_bound >= want.cost - rounding);
    }
}

TEST_CASE("volumes of many tiles and frames are cut exactly, the same with one thread and with two",
          "[long]") {
    struct Case {
        std::array<int, 3> size;
        int width;
        bool closed;
        Synthetic kind;
    };
    for (const auto& [size, width, closed, kind] :
         {Case{{12, 20, 16}, 24, false, Synthetic::smoke},
          Case{{10, 27, 12}, 32, true, Synthetic::noise},
          Case{{1, 2000, 1}, 50, false, Synthetic::noise},
          Case{{30, 81, 1}, 40, true, Synthetic::smoke}}) {
        const ColumnGraph graph(size, closed);
        const auto energy = SyntheticEnergy(kind, 7)({width, size[0], size[1]},
                                                     static_cast<std::size_t>(size[2]), closed);
        const auto band = Band::whole(graph.count(), {0, width - 1});
        REQUIRE(graph.count() * static_cast<std::size_t>(width - 1) > Cut::most_untiled);
        const CostAt cost = [&](std::size_t c, int entry) {
            return std::floor(energies_of(energy)(c, entry) * (1 << 20));
        };
        struct Solved {
            SeamVector seam;
            std::int64_t flow, cost;
        };
        const auto solve = [&](double tolerance) {
            Cut cut(columns_of(graph), band, whole_costs(cost));
            REQUIRE(cut.solve(tolerance, quiet));
            return Solved{cut.seam(), cut.flow(), cut.cost()};
        };
        INFO(size[0] << " x " << size[1] << " x " << size[2]);
        for (const double tolerance : {0.0, 0.01}) {
            const auto one = with_threads(1, [&] { return solve(tolerance); }),
                       two = with_threads(2, [&] { return solve(tolerance); });
            REQUIRE(one.seam == two.seam);
            REQUIRE(one.flow == two.flow);
            REQUIRE(is_seam(graph, band, one.seam));
            // A flow and a cut of the same size prove each other.
            REQUIRE(sum_along(one.seam, cost) == static_cast<double>(one.cost));
            REQUIRE(static_cast<double>(one.cost - one.flow) <=
                    tolerance * static_cast<double>(one.flow));
            if (tolerance == 0 && size[0] * size[2] == 1)
                REQUIRE(static_cast<double>(one.flow) == least_of_line(graph.count(), width, cost));
        }
    }
}

TEST_CASE("a seam that costs nothing is found in a large volume of dear ones") {
    std::mt19937 random(8);
    const ColumnGraph graph({14, 15, 16}, true);
    const auto hidden = random_seam(random, graph, {2, 27});
    const auto energy = volume_of(graph, 30, [&](std::size_t c, int entry) {
        return entry == hidden[c] ? 0.0 : 1 + static_cast<double>(random() % 64) / 64;
    });
    for (const int number : {0, 1})
        CHECK(exact_seam(energy, {0, 29}, number, quiet).at == SeamEntries(hidden));
}

TEST_CASE("seams hold together where more flow gathers in one place than an arc holds") {
    // On the left seams would stay above a staircase that leads down to the middle, on the right
    // below one that leads down from there. The stairs miss each other by a step, and all that any
    // seam pays flows through that one gap.
    constexpr int half = 150, width = 2 * half + 4, middle = half + 1;
    const ColumnGraph graph({2 * half, 1, 1});
    const double dear = 2047.0 / 64;
    const auto energy = volume_of(graph, width, [&](std::size_t c, int entry) {
        const int x = static_cast<int>(c) - half;
        return (x < 0 ? entry < middle - x : entry >= middle - x) ? dear : 0.0;
    });
    const auto want = least_of_line(graph.count(), width, energies_of(energy));
    REQUIRE(want == half * dear);
    for (const int number : {0, 1}) {
        int calls = 0;
        const auto patient = [&] {
            if (++calls > 5000) throw std::runtime_error("the cut does not come to an end");
        };
        const auto seam = exact_seam(energy, {0, width - 1}, number, patient);
        CHECK(is_seam(graph, Band::whole(graph.count(), {0, width - 1}), seam.at));
        CHECK(seam.energy == want);
        CHECK(seam.lower_bound == want);
    }
}

TEST_CASE(
    "the paper's keyframes: one interval is exact, more are never better, and seams go on from "
    "frame to frame") {
    std::mt19937 random(9);
    int worse = 0;
    for (int n = 0; n < 400; ++n) {
        const ColumnGraph graph({1 + n % 2, 1 + n % 3, 2 + static_cast<int>(random() % 2)},
                                n % 2 == 0);
        const int width = 2 + static_cast<int>(random() % 6);
        const auto energy = random_volume(random, graph, width);
        const Window window{0, width - 1};
        const auto band = Band::whole(graph.count(), window);
        const auto want = brute_force(graph, band, energies_of(energy));
        INFO("case " << n);
        const auto whole = keyframed_seam(energy, window, n, graph.size[2], 0, quiet);
        CHECK(whole.at == SeamEntries(n % 2 == 0 ? want.highest : want.lowest));
        for (int interval = 1; interval < graph.size[2]; ++interval) {
            const auto seam = keyframed_seam(energy, window, n, interval, 0, quiet);
            REQUIRE(is_seam(graph, band, seam.at));
            REQUIRE(seam.energy == sum_along(seam.at, energies_of(energy)));
            REQUIRE(seam.energy >= want.cost);
            worse += seam.energy > want.cost;
        }
        // The first interval knows nothing of the rest.
        const auto first = keyframed_seam(energy, window, n, 1, 0, quiet);
        const ColumnGraph frame({graph.size[0], graph.size[1], 1}, graph.closed);
        const auto alone =
            brute_force(frame, Band::whole(frame.count(), window), energies_of(energy));
        const auto& want_first = n % 2 == 0 ? alone.highest : alone.lowest;
        CHECK(std::equal(want_first.begin(), want_first.end(), first.at.begin()));
    }
    CHECK(worse > 100);
}

TEST_CASE("energies below the paper's threshold count as none for the cut, but are reported") {
    // 2 + 2 is dearer than 1 + 2.5, but for a cut that takes what is below 2.25 for nothing.
    const auto energy = volume_of(ColumnGraph({2, 1, 1}), 3, [](std::size_t c, int entry) {
        return entry == 0 ? (c == 0 ? 1.0 : 2.5) : entry == 1 ? 9.0 : 2.0;
    });
    const auto pruned = keyframed_seam(energy, {0, 2}, 0, 1, 2.25, quiet),
               plain = keyframed_seam(energy, {0, 2}, 0, 1, 0, quiet);
    CHECK(pruned.at == SeamEntries{2, 2});
    CHECK(pruned.energy == 4);
    CHECK(plain.at == SeamEntries{0, 0});
    CHECK(plain.energy == 3.5);
    CHECK(!pruned.lower_bound);
}

TEST_CASE("a cut ends when another task of its group fails meanwhile") {
    const auto energy = SyntheticEnergy(Synthetic::noise, 1)({40, 12, 14}, 9);
    std::atomic<bool> begun = false;
    const auto fail = [&] {
        while (!begun) std::this_thread::yield();
        throw Failure("no memory");
    };
    const auto cut = [&] {
        int calls = 0;
        exact_seam(energy, {0, 39}, 0, [&] {
            if (++calls != 3) return;
            begun = true;
            while (!tbb::is_current_task_group_canceling()) std::this_thread::yield();
        });
        begun = true;
    };
    CHECK_THROWS_AS(with_threads(2, [&] { tbb::parallel_invoke(fail, cut); }), Failure);
}
