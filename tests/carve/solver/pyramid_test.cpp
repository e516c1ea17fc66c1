#include "carve/solver/pyramid.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/greedy.h"
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

#include <atomic>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

Seams::Seam pyramid_seam(const EnergyVolume& energy, Window window, int number = 0,
                         Quality quality = Quality::normal) {
    return Pyramid(quality, 16)(energy, window, number, nobody);
}

std::size_t half_of(int size) { return (static_cast<std::size_t>(size) + 1) / 2; }

ColumnGraph halved(const ColumnGraph& graph) {
    return ColumnGraph({(graph.size[0] + 1) / 2, (graph.size[1] + 1) / 2, (graph.size[2] + 1) / 2},
                       graph.closed, graph.around);
}

}  // namespace

TEST_CASE("in small volumes the pyramid is exact") {
    std::mt19937 random(1);
    for (int n = 0; n < 500; ++n) {
        const ColumnGraph graph(random_size(random, 12), n % 2 == 0, n % 3 == 0);
        const int width = 1 + static_cast<int>(random() % 6);
        const auto energy = random_volume(random, graph, width);
        const auto window = random_window(random, width);
        const auto want =
            brute_force(graph, Band::whole(graph.count(), window), energies_of(energy));
        const auto seam = pyramid_seam(energy, window, n, static_cast<Quality>(n % 3));
        INFO("case " << n);
        REQUIRE(seam.at == SeamEntries(n % 2 == 0 ? want.highest : want.lowest));
        REQUIRE(seam.energy == want.cost);
        REQUIRE(seam.lower_bound == want.cost);
    }
}

TEST_CASE(
    "a pyramid's seams are feasible and never worse than greedy ones, in volumes of all sorts") {
    struct Case {
        std::array<int, 3> size;
        int width;
        bool closed;
        Synthetic kind;
    };
    unsigned seed = 0;
    // All are too large to be cut as a whole: odd rings, long and flat shapes, images.
    for (const auto& [size, width, closed, kind] :
         {Case{{13, 20, 21}, 57, false, Synthetic::noise},
          Case{{13, 21, 20}, 57, true, Synthetic::smoke},
          Case{{7, 9, 150}, 31, true, Synthetic::noise},
          Case{{1, 640, 1}, 480, false, Synthetic::smoke},
          Case{{640, 1, 1}, 480, false, Synthetic::noise},
          Case{{1, 101, 1}, 2700, true, Synthetic::smoke},
          Case{{60, 73, 1}, 66, true, Synthetic::smoke},
          Case{{70, 41, 50}, 2, true, Synthetic::noise},
          Case{{400, 3, 61}, 5, false, Synthetic::smoke}}) {
        const ColumnGraph graph(size, closed);
        const auto energy = SyntheticEnergy(kind, ++seed)(
            {width, size[0], size[1]}, static_cast<std::size_t>(size[2]), closed);
        const Window window =
            seed % 3 == 0 ? Window{width / 20, width - 1 - width / 30} : Window{0, width - 1};
        const auto band = Band::whole(graph.count(), window);
        const int number = static_cast<int>(seed % 2);
        const auto greedy = greedy_seam(energy, window, number, 16, nobody);
        INFO(size[0] << " x " << size[1] << " x " << size[2] << ", width " << width);
        for (const auto quality : {Quality::draft, Quality::normal, Quality::best}) {
            const auto seam = pyramid_seam(energy, window, number, quality);
            REQUIRE(is_seam(graph, band, seam.at));
            REQUIRE(seam.energy == Approx(sum_along(seam.at, energies_of(energy))));
            REQUIRE(seam.energy <= greedy.energy);
        }
    }
}

TEST_CASE("a pyramid that keeps the memory of other searches finds the same seam") {
    // Rings, large enough for messages that begin with coarse ones.
    for (const auto& [frames, field] :
         {std::pair(std::size_t{200}, false), std::pair(std::size_t{20}, true)}) {
        const auto made = [&, frames = frames, field = field](unsigned seed, float scale) {
            auto energy = SyntheticEnergy(Synthetic::smoke, seed)({97, 13, 21}, frames, true);
            for (std::size_t t = 0; t < frames; ++t)
                for (auto& code : energy.codes(t))
                    code = encode_energy(scale * decode_energy(code));
            if (field)
                add_field(energy, 0.5f, [&](auto, std::size_t n) {
                    return scale * static_cast<float>(n * n % 97);
                });
            return energy;
        };
        const Pyramid pyramid(Quality::normal, 16);
        // What this search leaves behind is larger than all that follows.
        pyramid(made(1, 100), {0, 96}, 0, nobody);
        const auto energy = made(2, 1);
        INFO("field " << field);
        CHECK(pyramid(energy, {0, 96}, 0, nobody).at == pyramid_seam(energy, {0, 96}).at);
    }
}

TEST_CASE("a pyramid comes near the least energy, the nearer the better the quality") {
    const std::array wanted{0.06, 0.015, 0.01};
    for (const bool closed : {false, true}) {
        const auto energy = SyntheticEnergy(Synthetic::smoke, 4)({40, 24, 32}, 10, closed);
        const double least = exact_seam(energy, {0, 39}, 0, quiet).energy;
        double before = greedy_seam(energy, {0, 39}, 0, 16, nobody).energy;
        for (const auto quality : {Quality::draft, Quality::normal, Quality::best}) {
            const double found = pyramid_seam(energy, {0, 39}, 0, quality).energy;
            INFO("quality " << static_cast<int>(quality) << ", closed " << closed << ": " << found
                            << " for " << least);
            CHECK(found >= least * (1 - 1e-6));
            CHECK(found <= least * (1 + wanted[static_cast<std::size_t>(quality)]));
            CHECK(found <= before);
            before = found;
        }
    }
}

TEST_CASE(
    "the seams of a set are each feasible in what the others leave, never worse than greedy there, "
    "for any threads") {
    const ColumnGraph graph({13, 21, 18}, true);
    constexpr int width = 60, count = 4;
    const Window window{3, 57};
    std::vector<FoundSeams> found;
    for (const std::size_t threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        tbb::task_arena arena(static_cast<int>(threads));
        arena.execute([&] {
            auto energy = SyntheticEnergy(Synthetic::smoke, 6)({width, 13, 21}, 18, true);
            found.push_back(find_seams(energy, {Seams::Kind::remove, window}, count,
                                       Pyramid(Quality::normal, 16), nobody));
        });
        for (std::size_t n = 0; n < count; ++n) {
            REQUIRE(found.back().seams[n].at == found.front().seams[n].at);
            REQUIRE(found.back().seams[n].energy == found.front().seams[n].energy);
        }
    }
    auto left = SyntheticEnergy(Synthetic::smoke, 6)({width, 13, 21}, 18, true);
    for (int n = 0; n < count; ++n) {
        const auto& seam = found.front().seams[static_cast<std::size_t>(n)];
        const Window now{window.first, window.last - n};
        REQUIRE(is_seam(graph, Band::whole(graph.count(), now), seam.at));
        CHECK(seam.energy == Approx(sum_along(seam.at, energies_of(left))));
        CHECK(seam.energy <= greedy_seam(left, now, n, 16, nobody).energy);
        left.remove(seam.at);
    }
}

TEST_CASE("static seams come from coarse to fine too") {
    const auto sum = SyntheticEnergy(Synthetic::smoke, 7)({70, 40, 110}, 3).sum();
    const ColumnGraph frame({40, 110, 1});
    const auto seam = pyramid_seam(sum, {0, 69});
    REQUIRE(is_seam(frame, Band::whole(frame.count(), {0, 69}), seam.at));
    CHECK(seam.energy <= greedy_seam(sum, {0, 69}, 0, 16, nobody).energy);
    CHECK(seam.energy <= 1.02 * exact_seam(sum, {0, 69}, 0, quiet).energy);
}

TEST_CASE("a pyramid stops when it is told to") {
    const auto energy = SyntheticEnergy(Synthetic::noise, 1)({60, 13, 21}, 18);
    std::atomic<int> calls = 0;
    const auto stop = [&](double) {
        if (++calls == 4) throw Cancelled{};
    };
    CHECK_THROWS_AS(Pyramid(Quality::normal, 16)(energy, {0, 59}, 0, stop), Cancelled);
}

TEST_CASE(
    "half the resolution: a coarse entry costs the mean over its columns of what its two entries "
    "cost together") {
    // How much dearer than the cheaper of two entries their pair is, as a share of the difference.
    const auto pair = volume_of(ColumnGraph({1, 1, 1}), 2,
                                [](std::size_t, int entry) { return entry == 0 ? 1.0 : 2.0; });
    const auto halved_pair = restrict_energy(pair, {0, 1}, pair.barrier());
    const double share = energies_of(halved_pair)(0, 0) - 1;
    REQUIRE(share >= 0);
    REQUIRE(share <= 0.5);
    std::mt19937 random(8);
    for (int n = 0; n < 300; ++n) {
        const ColumnGraph graph(random_size(random, 40), n % 2 == 0, n % 3 == 0);
        const int width = 1 + static_cast<int>(random() % 9);
        const auto codes = random_volume(random, graph, width);
        const bool summed = n % 3 == 0;
        const auto sums = codes.sum();
        const auto& energy = summed ? sums : codes;
        const ColumnGraph fine({graph.size[0], graph.size[1], summed ? 1 : graph.size[2]},
                               graph.closed, graph.around);
        const auto window = random_window(random, width);
        const auto coarse = restrict_energy(energy, window, energy.barrier());
        const auto expected = halved(fine);
        REQUIRE(coarse.width() == static_cast<int>(half_of(window.size())));
        REQUIRE(coarse.laterals() == expected.size[0]);
        REQUIRE(coarse.slices() == expected.size[1]);
        REQUIRE(coarse.frames() == static_cast<std::size_t>(expected.size[2]));
        REQUIRE(coarse.shape().closed == fine.closed);
        REQUIRE(coarse.shape().around == fine.around);

        const auto fine_energy = energies_of(energy), coarse_energy = energies_of(coarse);
        std::vector<double> sum(expected.count() * half_of(window.size()), 0.0),
            count(expected.count(), 0.0);
        for (std::size_t c = 0; c < fine.count(); ++c) {
            const auto place = columns_of(fine).place(c);
            const auto to =
                columns_of(expected).at(place.lateral / 2, place.slice / 2, place.t / 2);
            ++count[to];
            for (int entry = window.first; entry <= window.last; entry += 2) {
                const double a = fine_energy(c, entry),
                             b = fine_energy(c, std::min(entry + 1, window.last));
                sum[to * half_of(window.size()) +
                    static_cast<std::size_t>(entry - window.first) / 2] +=
                    std::min(a, b) + share * std::abs(a - b);
            }
        }
        INFO("case " << n);
        for (std::size_t c = 0; c < expected.count(); ++c)
            for (int entry = 0; entry < coarse.width(); ++entry) {
                const double want =
                    sum[c * half_of(window.size()) + static_cast<std::size_t>(entry)] / count[c];
                REQUIRE(coarse_energy(c, entry) == Approx(want).epsilon(2e-3).margin(1e-6));
            }
    }
}

TEST_CASE("half the resolution, with a price or without: where vertices are protected") {
    // Two columns of four entries; `x` is protected.
    auto energy = volume_of(ColumnGraph({2, 1, 1}), 4, [](std::size_t, int) { return 1.0; });
    const auto protect = [&](std::size_t column, std::size_t entry) {
        energy.codes(0)[4 * column + entry] = protected_code;
    };
    // x x . .
    // x . . x
    protect(0, 0);
    protect(0, 1);
    protect(1, 0);
    protect(1, 3);
    energy.find_marks();
    const auto free_somewhere =
        restrict_energy(energy, {0, 3}, std::numeric_limits<float>::infinity());
    CHECK_FALSE(free_somewhere.protects());
    CHECK(energies_of(free_somewhere)(0, 0) == 1);
    CHECK(energies_of(free_somewhere)(0, 1) == 1);
    CHECK(energies_of(restrict_energy(energy, {0, 3}, 7))(0, 0) == 4);
    protect(1, 1);
    const auto closed = restrict_energy(energy, {0, 3}, std::numeric_limits<float>::infinity());
    CHECK(closed.protects());
    CHECK(closed.codes(0)[0] == protected_code);
    CHECK(energies_of(closed)(0, 1) == 1);
    // Sums of frames have infinite costs instead of codes.
    const auto summed =
        restrict_energy(energy.sum(), {0, 3}, std::numeric_limits<float>::infinity());
    CHECK(summed.protects());
    CHECK(std::isinf(summed.cells<float>(0)[0]));
    CHECK(summed.cells<float>(0)[1] == 1);
}

TEST_CASE(
    "a seam of half the resolution becomes one of the whole, twice as high, in rings of any "
    "length") {
    std::mt19937 random(9);
    for (int n = 0; n < 2000; ++n) {
        const ColumnGraph fine(random_size(random, 120), n % 2 == 0, n % 3 == 0),
            coarse = halved(fine);
        const Window window{static_cast<int>(random() % 4), 4 + static_cast<int>(random() % 12)};
        const auto seam =
            random_seam(random, coarse, {0, static_cast<int>(half_of(window.size())) - 1});
        const auto out = prolong_seam(columns_of(coarse), seam, columns_of(fine), window);
        INFO("case " << n << ": " << fine.size[0] << " x " << fine.size[1] << " x "
                     << fine.size[2]);
        REQUIRE(is_seam(fine, Band::whole(fine.count(), window), out));
        const bool bent =
            (fine.closed && fine.size[1] % 2 != 0) || (fine.around && fine.size[0] % 2 != 0);
        for (std::size_t c = 0; c < out.size(); ++c) {
            const auto place = columns_of(fine).place(c);
            const int twice =
                window.first +
                2 * seam[columns_of(coarse).at(place.lateral / 2, place.slice / 2, place.t / 2)];
            REQUIRE(out[c] <= twice + 2);
            if (!bent) REQUIRE(out[c] >= twice - 1);
        }
    }
    const Columns fine(5, 7, 3, true), coarse(3, 4, 2, true);
    CHECK(prolong_seam(coarse, SeamVector(24, 3), fine, {1, 12}) == SeamVector(105, 7));
    // The last coarse entry of an odd window has one fine entry only.
    CHECK(prolong_seam(coarse, SeamVector(24, 3), fine, {1, 7}) == SeamVector(105, 7));
}

TEST_CASE(
    "sweeps over lines leave seams feasible, in their strip and no dearer, in rings of any "
    "length") {
    std::mt19937 random(10);
    for (int n = 0; n < 1000; ++n) {
        const ColumnGraph graph(random_size(random, 60), n % 2 == 0, n % 3 == 0);
        const int width = 1 + static_cast<int>(random() % 12);
        const auto energy = random_volume(random, graph, width, n % 4 == 0 ? 3 : 1024);
        const auto window = random_window(random, width);
        auto seam = random_seam(random, graph, window);
        const Strip strip(energy, Band::around(seam, 1 + n % 3, window));
        double before = energy_of(energy, seam);
        REQUIRE(before == sum_along(seam, energies_of(energy)));
        INFO("case " << n);
        const LineSweeps sweep_lines(strip);
        for (int turn = 0; turn < 4; ++turn) {
            sweep_lines(seam, turn);
            REQUIRE(is_seam(graph, strip.band(), seam));
            const double after = energy_of(energy, seam);
            REQUIRE(after <= before);
            REQUIRE(strip.energy(seam) == after);
            before = after;
        }
    }
}

TEST_CASE("a sweep moves the one line of an image or a ring as well as can be, by an entry") {
    std::mt19937 random(11);
    for (int n = 0; n < 1000; ++n) {
        std::array<int, 3> size{1, 1, 1};
        size[static_cast<std::size_t>(n % 3)] = 2 + static_cast<int>(random() % 9);
        const ColumnGraph graph(size, n % 2 == 0);
        const auto energy = random_volume(random, graph, 8);
        auto seam = random_seam(random, graph, {0, 7});
        const Strip strip(energy, Band::around(seam, 2, {0, 7}));
        const int turn = n % 4;
        auto near = Band::around(seam, 1, {0, 7});
        for (std::size_t c = 0; c < seam.size(); ++c)
            near.columns[c] = {static_cast<std::uint16_t>(std::max(seam[c] - 1, 0)),
                               static_cast<std::uint16_t>(std::min(seam[c] + 1, 7))};
        const auto least = [&] { return brute_force(graph, near, energies_of(energy)).cost; };
        const auto given = seam;
        LineSweeps{strip}(seam, turn);
        const double found = sum_along(seam, energies_of(energy));
        INFO("case " << n);
        if (!graph.closed || size[1] == 1) {
            REQUIRE(found == least());
            continue;
        }
        // A ring's seam stays in one slice.
        double best = std::numeric_limits<double>::infinity();
        for (std::size_t still = 0; still < seam.size(); ++still) {
            if (seam[still] != given[still]) continue;
            const auto column =
                std::exchange(near.columns[still], Band::Column{given[still], given[still]});
            const double with_this = least();
            near.columns[still] = column;
            if (found == with_this) best = with_this;
        }
        REQUIRE(found == best);
    }
}
