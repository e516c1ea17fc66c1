#include "carve/solver/costs/step_costs.h"
#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/dynamic.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/bound.h"
#include "carve/solver/search/coarse.h"
#include "carve/solver/search/line_sweeps.h"
#include "carve/solver/search/strip.h"
#include "carve/volume/volume.h"
#include "tests/support/brute_force.h"
#include "tests/support/searches.h"
#include "tests/support/synthetic_energy.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <catch2/catch.hpp>

#include <cmath>

using namespace fluidcarve;
using namespace fluidcarve::test;

// What seams pay beside the energies of their entries: rigidity, and the edges that come to be
// where they were.

namespace {

/// A volume whose seams pay for steps and edges, and beside it, in plain numbers, what they pay.
/// Multiples of 1/64, which neither codes nor sums round.
struct Paid {
    ColumnGraph graph;
    int width;
    std::array<float, 2> rigidity;
    double weight;  ///< of the field; none: 0
    std::vector<double> energies, field;

    Paid(std::mt19937& random, const std::array<int, 3>& size, bool closed, int width, bool forward)
        : graph(size, closed),
          width(width),
          rigidity{static_cast<float>(random() % 3) * 2, static_cast<float>(random() % 3) * 3},
          weight(forward ? 0.5 : 0),
          energies(graph.count() * static_cast<std::size_t>(width)),
          field(energies.size()) {
        for (auto& energy : energies) energy = static_cast<double>(random() % 512) / 64;
        for (auto& value : field) value = static_cast<double>(random() % 512) / 32 - 8;
        // In half of the volumes content fills a part of each column only, or none of it.
        if (random() % 2 == 0) return;
        for (std::size_t c = 0; c < graph.count(); ++c) {
            const auto first = static_cast<int>(random() % static_cast<unsigned>(width + 1)),
                       last = static_cast<int>(random() % static_cast<unsigned>(width + 1));
            for (int entry = 0; entry < width; ++entry)
                if (entry < first || entry > last)
                    field[c * static_cast<std::size_t>(width) + static_cast<std::size_t>(entry)] =
                        0;
        }
    }

    double at(const std::vector<double>& of, std::size_t c, int entry) const {
        return of[c * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(std::clamp(entry, 0, width - 1))];
    }
    CostAt cost() const {
        return [this](std::size_t c, int entry) {
            return at(energies, c, entry) +
                   weight * std::abs(at(field, c, entry + 1) - at(field, c, entry - 1));
        };
    }
    StepAt step() const {
        return [this](std::size_t c, int entry, std::size_t other, int there) {
            if (entry == there) return 0.0;
            if (entry < there) {
                std::swap(c, other);
                std::swap(entry, there);
            }
            const auto per_frame = static_cast<std::size_t>(graph.size[0] * graph.size[1]);
            const auto rigid = rigidity[c / per_frame != other / per_frame];
            return static_cast<double>(rigid) +
                   weight * std::abs(at(field, c, there) - at(field, other, entry));
        };
    }
    template <class Entries>
    double operator()(const Entries& seam) const {
        return sum_along(seam, cost()) + sum_of_steps(graph, seam, step());
    }
    Least least(const Band& band) const { return brute_force(graph, band, cost(), step()); }
    Least least(Window window) const { return least(Band::whole(graph.count(), window)); }

    EnergyVolume volume() const {
        auto out = volume_of(graph, width,
                             [&](std::size_t c, int entry) { return at(energies, c, entry); });
        out.set_step_prices({.rigidity = rigidity});
        if (weight == 0) return out;
        add_field(out, static_cast<float>(weight), [&](std::size_t t, std::size_t n) {
            return field[t * out.columns_per_frame() * out.stride() + n];
        });
        out.count_edges({});
        return out;
    }
    /// What a seam leaves.
    void remove(std::span<const std::uint16_t> seam) {
        for (auto* const values : {&energies, &field}) {
            std::vector<double> out;
            for (std::size_t n = 0; n < values->size(); ++n)
                if (n % static_cast<std::size_t>(width) !=
                    seam[n / static_cast<std::size_t>(width)])
                    out.push_back((*values)[n]);
            *values = out;
        }
        --width;
    }
};

Paid random_paid(std::mt19937& random, int n, int most_columns = 11) {
    return {random, random_size(random, most_columns), n % 2 == 0,
            1 + static_cast<int>(random() % 6), n % 3 != 0};
}

/// Smoke of any size whose seams pay for the edges in another smoke.
EnergyVolume forward_smoke(const std::array<int, 3>& shape, std::size_t frames, bool closed) {
    auto out = SyntheticEnergy(Synthetic::smoke, 3)(shape, frames, closed);
    const auto field = SyntheticEnergy(Synthetic::smoke, 4)(shape, frames, closed);
    out.set_step_prices({.rigidity = {0.02f, 0.05f}});
    add_field(out, 0.5f,
              [&](std::size_t t, std::size_t n) { return decode_energy(field.codes(t)[n]); });
    out.count_edges({});
    return out;
}

}  // namespace

TEST_CASE("codes of a field hold what half floats do, and say what they do not") {
    for (unsigned code = 0; code < 0x7C00; ++code) {
        const auto value = decode_field(static_cast<std::uint16_t>(code));
        REQUIRE(encode_field(value) == code);
        REQUIRE(encode_field(-value) == (code | 0x8000u));
        REQUIRE(decode_field(static_cast<std::uint16_t>(code | 0x8000u)) == -value);
        if (code > 0) REQUIRE(value > decode_field(static_cast<std::uint16_t>(code - 1)));
    }
    CHECK(decode_field(encode_field(1.0f)) == 1.0f);
    CHECK(decode_field(encode_field(-0.1f)) == Approx(-0.1).epsilon(0x1p-11));
    CHECK(decode_field(encode_field(65504.0f)) == 65504.0f);
    for (const float value : {65505.0f, -1e6f, INFINITY, -INFINITY, NAN})
        CHECK(encode_field(value) == invalid_field_code);
}

TEST_CASE("forward, a seam pays for its energy and for each edge that its removal makes") {
    std::mt19937 random(1);
    for (int n = 0; n < 500; ++n) {
        Paid paid(random, random_size(random, 12), n % 2 == 0, 3 + static_cast<int>(random() % 4),
                  true);
        paid.rigidity = {0, 0};
        // Away from the ends, whose removal makes no edge.
        auto seam = random_seam(random, paid.graph, {1, paid.width - 2});
        const auto volume = paid.volume();
        auto after = paid;
        after.remove(seam);
        double want = 0;
        for (std::size_t c = 0; c < seam.size(); ++c) {
            want += paid.at(paid.energies, c, seam[c]);
            want += paid.weight * std::abs(after.at(after.field, c, seam[c]) -
                                           after.at(after.field, c, seam[c] - 1));
            for (const auto other : paid.graph.neighbours[c])
                for (int entry = 0; other < c && entry < after.width; ++entry) {
                    const bool moved = entry >= seam[c], moved_there = entry >= seam[other];
                    if (moved != moved_there)
                        want += paid.weight * std::abs(after.at(after.field, c, entry) -
                                                       after.at(after.field, other, entry));
                }
        }
        INFO("case " << n);
        REQUIRE(energy_of(volume, seam) == want);
        REQUIRE(cost_of(volume, seam) == want);
    }
}

TEST_CASE("what a seam leaves costs as if it had always been so") {
    std::mt19937 random(2);
    for (int n = 0; n < 200; ++n) {
        Paid paid(random, random_size(random, 12), n % 2 == 0, 4, true);
        auto volume = paid.volume();
        for (int removed = 0; removed < 3; ++removed) {
            const auto seam = random_seam(random, paid.graph, {0, paid.width - 1});
            volume.remove(seam);
            paid.remove(seam);
            const auto next = random_seam(random, paid.graph, {0, paid.width - 1});
            INFO("case " << n << ", after " << removed + 1 << " seams");
            REQUIRE(energy_of(volume, next) == paid(next));
        }
    }
}

TEST_CASE(
    "exact seams with steps and edges cost the least of all, in any window, to the last digit") {
    std::mt19937 random(3);
    for (int n = 0; n < 4000; ++n) {
        const auto paid = random_paid(random, n);
        const auto window = random_window(random, paid.width);
        const auto least = paid.least(window);
        const auto volume = paid.volume();
        const auto seam = exact_seam(volume, window, n, quiet);
        INFO("case " << n);
        REQUIRE(is_seam(paid.graph, Band::whole(paid.graph.count(), window), seam.at));
        REQUIRE(paid(seam.at) == least.cost);
        REQUIRE(seam.energy == least.cost);
        REQUIRE(seam.lower_bound == least.cost);
        REQUIRE(SeamVector(seam.at.begin(), seam.at.end()) ==
                (n % 2 == 0 ? least.highest : least.lowest));
    }
}

TEST_CASE("the same in bands of any form, whose ends differ from column to column") {
    std::mt19937 random(4);
    for (int n = 0; n < 3000; ++n) {
        const auto paid = random_paid(random, n);
        const auto band = random_band(random, paid.graph, {0, paid.width - 1});
        const auto least = paid.least(band).cost;
        const auto cut = cut_seam(paid.volume(), band, 0, n, quiet);
        INFO("case " << n);
        REQUIRE(is_seam(paid.graph, band, cut.at));
        REQUIRE(paid(cut.at) == least);
        REQUIRE(cut.lower_bound == least);
    }
}

TEST_CASE("static seams pay for steps in every frame") {
    std::mt19937 random(5);
    for (int n = 0; n < 300; ++n) {
        Paid paid(random, random_size(random, 10), n % 2 == 0, 4, false);
        const auto sum = paid.volume().sum();
        const ColumnGraph frame({paid.graph.size[0], paid.graph.size[1], 1}, n % 2 == 0);
        const auto band = Band::whole(frame.count(), {0, 3});
        const auto frames = paid.graph.size[2];
        const auto least = brute_force(
            frame, band,
            [&](std::size_t c, int entry) {
                double out = 0;
                for (int t = 0; t < frames; ++t)
                    out += paid.cost()(c + static_cast<std::size_t>(t) * frame.count(), entry);
                return out;
            },
            [&](std::size_t, int entry, std::size_t, int there) {
                return entry == there ? 0.0 : frames * static_cast<double>(paid.rigidity[0]);
            });
        INFO("case " << n);
        REQUIRE(exact_seam(sum, {0, 3}, n, quiet).energy == least.cost);
    }
}

TEST_CASE("dynamic programming pays for steps and edges too, along a line in space or time") {
    std::mt19937 random(6);
    for (int n = 0; n < 2000; ++n) {
        std::array<int, 3> size{1, 1, 1};
        size[static_cast<std::size_t>(n % 3)] = 1 + static_cast<int>(random() % 10);
        const Paid paid(random, size, n % 2 == 0, 1 + static_cast<int>(random() % 6), n % 5 != 0);
        const auto window = random_window(random, paid.width);
        const auto seam = DynamicSeams()(paid.volume(), window, n, nobody);
        INFO("case " << n);
        REQUIRE(is_seam(paid.graph, Band::whole(paid.graph.count(), window), seam.at));
        REQUIRE(paid(seam.at) == paid.least(window).cost);
        REQUIRE(seam.energy == paid(seam.at));
    }
}

TEST_CASE(
    "no seam costs less than the lower bound where steps cost something, and along an open line it "
    "is the least") {
    std::mt19937 random(7);
    for (int n = 0; n < 2000; ++n) {
        const auto paid = random_paid(random, n);
        const auto window = random_window(random, paid.width);
        const auto least = paid.least(window).cost;
        const auto volume = paid.volume();
        const bool line = std::ranges::count(paid.graph.size, 1) >= 2 &&
                          (!paid.graph.closed || paid.graph.size[1] == 1);
        INFO("case " << n);
        for (const int passes : {0, 1, 20}) {
            const auto bound = lower_bound(volume, window, passes, nobody);
            REQUIRE(bound <= least);
            if (line) REQUIRE(bound == Approx(least).epsilon(1e-4));
        }
    }
}

TEST_CASE("a greedy seam takes the cheapest entry with its steps to the neighbours passed") {
    std::mt19937 random(8);
    for (int n = 0; n < 1000; ++n) {
        const auto paid = random_paid(random, n, 24);
        const auto window = random_window(random, paid.width);
        const auto seam = greedy_seam(paid.volume(), window, n, 1, nobody);
        INFO("case " << n);
        REQUIRE(is_seam(paid.graph, Band::whole(paid.graph.count(), window), seam.at));
        REQUIRE(seam.energy == paid(seam.at));
        const int slices = paid.graph.size[1];
        const auto frame = static_cast<std::size_t>(paid.graph.size[0] * slices);
        for (std::size_t c = 1; c < seam.at.size(); ++c) {
            const int k = static_cast<int>(c % frame) / paid.graph.size[0];
            const int home = seam.at[c - static_cast<std::size_t>(k * paid.graph.size[0])];
            const auto cost = [&](int entry) {
                double out = paid.cost()(c, entry);
                for (const auto other : paid.graph.neighbours[c]) {
                    if (other > c) continue;
                    if (std::abs(entry - seam.at[other]) > 1)
                        return std::numeric_limits<double>::infinity();
                    out += paid.step()(c, entry, other, seam.at[other]);
                }
                // Farther off a ring's seam could not close.
                return paid.graph.closed && k > 0 && std::abs(entry - home) > slices - k
                           ? std::numeric_limits<double>::infinity()
                           : out;
            };
            for (int entry = window.first; entry <= window.last; ++entry)
                REQUIRE(cost(seam.at[c]) <= cost(entry));
        }
    }
}

TEST_CASE("sweeps over lines leave no seam dearer, steps and edges counted") {
    std::mt19937 random(9);
    int better = 0;
    for (int n = 0; n < 1000; ++n) {
        const Paid paid(random, random_size(random, 40), n % 2 == 0, 6, n % 3 != 0);
        const auto volume = paid.volume();
        const auto before = random_seam(random, paid.graph, {0, 5});
        const Strip strip(volume, Band::around(before, 2, {0, 5}));
        auto seam = before;
        LineSweeps{strip}(seam, n);
        INFO("case " << n);
        REQUIRE(is_seam(paid.graph, strip.band(), seam));
        REQUIRE(paid(seam) <= paid(before));
        REQUIRE(strip.energy(seam) == paid(seam));
        better += paid(seam) < paid(before);
    }
    CHECK(better > 500);
}

TEST_CASE("the paper's keyframes pay for the steps between intervals") {
    std::mt19937 random(10);
    {
        // Below the threshold both entries cost nothing, but the step there does.
        auto energy = volume_of(ColumnGraph({1, 1, 2}), 2, [](std::size_t c, int entry) {
            return c == 0 ? 9 * entry : 1 - entry;
        });
        energy.set_step_prices({.rigidity = {0, 3}});
        CHECK(keyframed_seam(energy, {0, 1}, 0, 1, 5, quiet).at[1] == 0);
    }
    for (int n = 0; n < 500; ++n) {
        const Paid paid(random, {1 + n % 2, 2, 4}, n % 3 == 0, 4, n % 2 == 0);
        const auto volume = paid.volume();
        const auto least = paid.least(Window{0, 3}).cost;
        INFO("case " << n);
        REQUIRE(keyframed_seam(volume, {0, 3}, n, 4, 0, quiet).energy == least);
        const auto seam = keyframed_seam(volume, {0, 3}, n, 1, 0, quiet);
        REQUIRE(seam.energy == paid(seam.at));
        REQUIRE(seam.energy >= least);
        // Frame by frame, the first as if it were alone, each other as the one before allows.
        const auto columns = static_cast<std::size_t>(paid.graph.size[0] * paid.graph.size[1]);
        const ColumnGraph frame({paid.graph.size[0], paid.graph.size[1], 1}, paid.graph.closed);
        for (std::size_t t = 0; t < 4; ++t) {
            auto band = Band::whole(columns, {0, 3});
            const auto home = [&](std::size_t c) -> int { return seam.at[(t - 1) * columns + c]; };
            for (std::size_t c = 0; t > 0 && c < columns; ++c)
                band.columns[c] = {static_cast<std::uint16_t>(std::max(home(c) - 1, 0)),
                                   static_cast<std::uint16_t>(std::min(home(c) + 1, 3))};
            const auto cost = [&](std::size_t c, int entry) {
                return paid.cost()(t * columns + c, entry) +
                       (t > 0 ? paid.step()(t * columns + c, entry, (t - 1) * columns + c, home(c))
                              : 0);
            };
            const auto step = [&](std::size_t c, int entry, std::size_t other, int there) {
                return paid.step()(t * columns + c, entry, t * columns + other, there);
            };
            const SeamVector part(seam.at.begin() + static_cast<std::ptrdiff_t>(t * columns),
                                  seam.at.begin() + static_cast<std::ptrdiff_t>((t + 1) * columns));
            REQUIRE(sum_along(part, cost) + sum_of_steps(frame, part, step) ==
                    brute_force(frame, band, cost, step).cost);
        }
    }
}

TEST_CASE("in small volumes the pyramid is exact with steps and edges") {
    std::mt19937 random(11);
    for (int n = 0; n < 300; ++n) {
        const auto paid = random_paid(random, n);
        const auto seam =
            Pyramid(Quality::normal, 4)(paid.volume(), {0, paid.width - 1}, n, nobody);
        INFO("case " << n);
        REQUIRE(seam.energy == paid.least(Window{0, paid.width - 1}).cost);
    }
}

TEST_CASE(
    "in large volumes it comes near the least cost, with any number of threads, and never behind "
    "the greedy search",
    "[long]") {
    for (const bool closed : {false, true}) {
        const auto energy = forward_smoke({40, 20, 30}, 12, closed);
        const Window window{0, 39};
        const auto exact = exact_seam(energy, window, 0, quiet);
        const auto greedy = greedy_seam(energy, window, 0, 16, nobody);
        const auto find = [&] { return Pyramid(Quality::normal, 16)(energy, window, 0, nobody); };
        const auto seam = with_threads(1, find);
        INFO((closed ? "closed" : "open") << ": exact " << exact.energy << ", pyramid "
                                          << seam.energy << ", greedy " << greedy.energy);
        CHECK(exact.energy == Approx(*exact.lower_bound).epsilon(1e-5));
        CHECK(seam.energy <= 1.02 * exact.energy);
        CHECK(seam.energy >= exact.energy * (1 - 1e-6));
        CHECK(seam.energy <= greedy.energy);
        CHECK(seam.energy == Approx(energy_of(energy, seam.at)));
        CHECK(lower_bound(energy, window, 10, nobody) <= exact.energy);
        CHECK(with_threads(2, find).at == seam.at);
        CHECK(with_threads(1, [&] { return exact_seam(energy, window, 0, quiet); }).at == exact.at);
    }
}

TEST_CASE("steps dearer than all energies leave the cheapest straight seam") {
    std::mt19937 random(12);
    for (int n = 0; n < 200; ++n) {
        const ColumnGraph graph({4, 4, 1 + n % 3}, n % 2 == 0);
        auto energy = random_volume(random, graph, 5);
        for (const float rigidity : {1e4f, 1e7f, 1e30f}) {
            energy.set_step_prices({.rigidity = {rigidity, rigidity}});
            double least = std::numeric_limits<double>::infinity();
            for (std::uint16_t entry = 0; entry < 5; ++entry)
                least = std::min(least, energy_of(energy, SeamVector(graph.count(), entry)));
            INFO("case " << n << ", rigidity " << rigidity);
            REQUIRE(exact_seam(energy, {0, 4}, n, quiet).energy == least);
            REQUIRE(Pyramid(Quality::normal, 4)(energy, {0, 4}, n, nobody).energy == least);
        }
    }
}

TEST_CASE("half the resolution: a coarse field is the mean, and its edges weigh half") {
    std::mt19937 random(13);
    for (int volumes = 0; volumes < 8; ++volumes) {
        const Paid paid(random, {3, 4, 5}, false, 6, true);
        const auto volume = paid.volume();
        const auto coarse = restrict_energy(volume, {1, 5}, volume.barrier());
        REQUIRE(coarse.step_prices().edge == volume.step_prices().edge / 2);
        REQUIRE(coarse.step_prices().rigidity == volume.step_prices().rigidity);
        for (int t = 0; t < 3; ++t)
            for (int k = 0; k < 2; ++k)
                for (int lateral = 0; lateral < 2; ++lateral)
                    for (int entry = 0; entry < 3; ++entry) {
                        double sum = 0;
                        int count = 0;
                        for (int n = 0; n < 16; ++n) {
                            const int l = 2 * lateral + (n & 1), z = 2 * k + (n >> 1 & 1),
                                      frame = 2 * t + (n >> 2 & 1),
                                      i = 1 + 2 * entry + (n >> 3 & 1);
                            if (l >= 3 || frame >= 5 || i > 5) continue;
                            sum += paid.at(paid.field,
                                           static_cast<std::size_t>(l + 3 * (z + 4 * frame)), i);
                            ++count;
                        }
                        const auto place = static_cast<std::size_t>((lateral + 2 * k) * 3 + entry);
                        CHECK(decode_field(coarse.field_codes(static_cast<std::size_t>(
                                  t))[place]) == Approx(sum / count).epsilon(1e-3).margin(1e-3));
                    }
    }
}

TEST_CASE("rigid seams step less, in space or in time, and none at all if it is dear enough") {
    const auto steps_of = [](const std::array<float, 2>& rigidity) {
        auto energy = SyntheticEnergy(Synthetic::noise, 5)({20, 8, 10}, 8);
        energy.set_step_prices({.rigidity = rigidity});
        const auto seam = exact_seam(energy, {0, 19}, 0, quiet);
        const Columns columns(energy);
        std::array<int, 2> out{};
        for (std::size_t c = 0; c < columns.count(); ++c) {
            const auto neighbours = columns.neighbours(c, columns.place(c));
            for (std::size_t d = 1; d < neighbours.size(); d += 2)
                if (neighbours[d] != Columns::none)
                    out[d / 2 == 2] += std::abs(seam.at[c] - seam.at[neighbours[d]]);
        }
        return out;
    };
    const auto free = steps_of({0, 0}), in_space = steps_of({0.1f, 0}),
               in_time = steps_of({0, 0.1f});
    CHECK(in_space[0] < free[0]);
    CHECK(in_time[1] < free[1]);
    CHECK(in_time[1] < in_space[1]);
    CHECK(in_space[0] < in_time[0]);
    for (const float dear : {100.0f, 1e7f, 1e30f})
        CHECK(steps_of({dear, dear}) == std::array{0, 0});
}
