#include "carve/solver/greedy.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/task/task_bounds.h"
#include "carve/volume/volume.h"
#include "nodes/seam.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"
#include "tests/support/searches.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>

#include <random>
#include <set>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

EnergyVolume volume(const std::array<int, 3>& shape, Axis axis, std::size_t frames,
                    const std::function<float(std::size_t t, std::size_t n)>& energy,
                    bool closed = false) {
    EnergyVolume out({shape, axis, frames, closed});
    for (std::size_t t = 0; t < frames; ++t)
        for (std::size_t n = 0; n < out.codes(t).size(); ++n)
            out.codes(t)[n] = encode_energy(energy(t, n));
    return out;
}

EnergyVolume noise(const std::array<int, 3>& shape, Axis axis, std::size_t frames, unsigned seed,
                   bool closed = false) {
    std::mt19937 random(seed);
    return volume(
        shape, axis, frames,
        [&](std::size_t, std::size_t) { return static_cast<float>(random() % 1000) / 100; },
        closed);
}

struct ColumnSizes {
    int laterals, slices, frames;
    template <class Entries>
    int largest_jump(const Entries& at) const {
        int out = 0;
        for (int t = 0; t < frames; ++t)
            for (int k = 0; k < slices; ++k)
                for (int j = 0; j < laterals; ++j) {
                    const auto entry = [&](int j, int k, int t) {
                        return int(at[static_cast<std::size_t>(j + laterals * (k + slices * t))]);
                    };
                    if (j) out = std::max(out, std::abs(entry(j, k, t) - entry(j - 1, k, t)));
                    if (k) out = std::max(out, std::abs(entry(j, k, t) - entry(j, k - 1, t)));
                    if (t) out = std::max(out, std::abs(entry(j, k, t) - entry(j, k, t - 1)));
                }
        return out;
    }
    /// Between the last slice and the first.
    template <class Entries>
    int largest_gap(const Entries& at) const {
        int out = 0;
        for (int t = 0; t < frames; ++t)
            for (int j = 0; j < laterals; ++j) {
                const auto entry = [&](int k) {
                    return int(at[static_cast<std::size_t>(j + laterals * (k + slices * t))]);
                };
                out = std::max(out, std::abs(entry(0) - entry(slices - 1)));
            }
        return out;
    }
};

double cost(EnergyVolume& energy, std::span<const std::uint16_t> at) {
    double out = 0;
    for (std::size_t c = 0; c < at.size(); ++c)
        out += decode_energy(energy.codes(
            c /
            energy.columns_per_frame())[c % energy.columns_per_frame() * energy.stride() + at[c]]);
    return out;
}

/// The greedy seam from one start, straight from its definition.
std::vector<std::uint16_t> by_definition(EnergyVolume& energy, Window window, int start,
                                         const ColumnSizes& shape, bool below_first) {
    std::vector<std::uint16_t> at;
    for (int t = 0; t < shape.frames; ++t)
        for (int k = 0; k < shape.slices; ++k)
            for (int j = 0; j < shape.laterals; ++j) {
                const auto strays = [&](int i) {
                    return energy.shape().closed && k > 0 &&
                           std::abs(i - int(at[static_cast<std::size_t>(
                                            j + shape.laterals * shape.slices * t)])) >
                               shape.slices - k;
                };
                const auto before = [&](int columns) {
                    return int(at[at.size() - static_cast<std::size_t>(columns)]);
                };
                std::vector<int> neighbours;
                if (j > 0) neighbours.push_back(before(1));
                if (k > 0) neighbours.push_back(before(shape.laterals));
                if (t > 0) neighbours.push_back(before(shape.laterals * shape.slices));
                const auto* const column =
                    energy.codes(static_cast<std::size_t>(t)).data() +
                    static_cast<std::size_t>(j + shape.laterals * k) * energy.stride();
                int best = -1;
                const auto rank = [&](int i) {
                    return i == neighbours[0] ? 0 : (i < neighbours[0]) == below_first ? 1 : 2;
                };
                for (int i = window.first; i <= window.last; ++i) {
                    if (neighbours.empty() ? i != start
                                           : std::ranges::any_of(neighbours, [&](int n) {
                                                 return std::abs(i - n) > 1;
                                             }))
                        continue;
                    if (strays(i)) continue;
                    if (best < 0 || column[i] < column[best] ||
                        (column[i] == column[best] && rank(i) < rank(best)))
                        best = i;
                }
                at.push_back(static_cast<std::uint16_t>(best));
            }
    return at;
}

}  // namespace

TEST_CASE(
    "a greedy seam takes the cheapest entry that its passed neighbours allow, and the best start "
    "wins") {
    for (unsigned seed = 0; seed < 80; ++seed) {
        const ColumnSizes shape{1 + int(seed % 7), 1 + int(seed % 5), 1 + int(seed % 4)};
        const auto axis = seed % 2 ? Axis::u : Axis::v;
        const int width = 3 + int(seed % 9);
        auto energy = noise(axis == Axis::u ? std::array{width, shape.laterals, shape.slices}
                                            : std::array{shape.laterals, width, shape.slices},
                            axis, static_cast<std::size_t>(shape.frames), seed, seed >= 40);
        const Window window{int(seed % 3), width - 1};
        const auto seam = greedy_seam(energy, window, int(seed), 100, nobody);

        double best = 1e30;
        std::vector<std::uint16_t> want;
        for (int start = window.first; start <= window.last; ++start) {
            auto at = by_definition(energy, window, start, shape, seed % 2 == 0);
            if (const double sum = cost(energy, at); sum < best) {
                best = sum;
                want = at;
            }
        }
        INFO("seed " << seed);
        CHECK(seam.at == want);
        CHECK(seam.energy == Approx(best));
        CHECK(shape.largest_jump(seam.at) <= 1);
    }
}

TEST_CASE(
    "a greedy search within a cost finds the same seam, or none if each costs more, with bounds "
    "and without") {
    int found = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
        // Steps are dear in some, and some are rings.
        auto energy = noise({14, 3, 4}, Axis::u, 1 + seed % 6, seed, seed % 4 == 0);
        if (seed % 3 == 0) energy.set_step_prices({.rigidity = {0.5f, 0.25f}});
        const Window window{1, 12};
        const auto free = greedy_seam(energy, window, int(seed), 40, nobody);
        TaskBounds bounds(4, 0, [] {}, {0, Scratch().path()});
        REQUIRE(bounds.find(energy, window, 0, nobody));
        for (const double share : {0.0, 0.5, 0.99, 1.0001, 1.2, 3.0})
            for (const auto* const given : {static_cast<const TaskBounds*>(nullptr),
                                            static_cast<const TaskBounds*>(&bounds)}) {
                const auto seam = greedy_seam_within(energy, window, int(seed), 40,
                                                     share * free.energy, nobody, given);
                INFO("seed " << seed << ", share " << share << ", bounds " << (given != nullptr));
                REQUIRE(seam.has_value() == (share > 1));
                if (!seam) continue;
                CHECK(seam->at == free.at);
                CHECK(seam->energy == free.energy);
                ++found;
            }
    }
    CHECK(found == 240);
}

TEST_CASE("starts stand at the centres of equal parts of the window") {
    // One column: the seam is its start. Only entries 3, 8 and 13 of 1 to 15 are tried by three
    // starts.
    for (int cheap = 0; cheap < 17; ++cheap) {
        auto energy = volume({17, 1, 1}, Axis::u, 1, [&](std::size_t, std::size_t n) {
            return int(n) == cheap ? 0.0f : 1.0f;
        });
        const auto seam = greedy_seam(energy, {1, 15}, 0, 3, nobody);
        const bool tried = cheap == 3 || cheap == 8 || cheap == 13;
        CHECK(seam.at[0] == (tried ? cheap : 3));
    }
}

TEST_CASE("on flat energy seams are straight") {
    auto energy = volume({9, 6, 5}, Axis::u, 4, [](std::size_t, std::size_t) { return 2.0f; });
    const auto found = find_seams(energy, {Seams::Kind::remove, {0, 8}}, 3, greedy(4), nobody);
    for (const auto& seam : found.seams) {
        CHECK(std::set(seam.at.begin(), seam.at.end()).size() == 1);
        CHECK(seam.energy == 2.0 * 6 * 5 * 4);
    }
}

TEST_CASE("of equal ways aside, even seams take the one below and odd seams the one above") {
    // Staying is dear, both sides are free.
    auto energy = volume({5, 2, 1}, Axis::u, 1, [](std::size_t, std::size_t n) {
        return n == 2 || n == 5 + 1 || n == 5 + 3 ? 0.0f : 1.0f;
    });
    CHECK(greedy_seam(energy, {0, 4}, 0, 5, nobody).at == std::vector<std::uint16_t>{2, 1});
    CHECK(greedy_seam(energy, {0, 4}, 1, 5, nobody).at == std::vector<std::uint16_t>{2, 3});
}

TEST_CASE("seams after the first are found in what the others left, inside a window that shrinks") {
    const ColumnSizes shape{6, 5, 3};
    auto energy = noise({12, 6, 5}, Axis::u, 3, 3), state = noise({12, 6, 5}, Axis::u, 3, 3);
    const Window window{2, 9};
    const auto found = find_seams(energy, {Seams::Kind::remove, window}, 8, greedy(16), nobody);
    REQUIRE(found.seams.size() == 8);
    for (int n = 0; n < 8; ++n) {
        const auto& seam = found.seams[static_cast<std::size_t>(n)];
        CHECK(shape.largest_jump(seam.at) <= 1);
        CHECK(*std::ranges::min_element(seam.at) >= window.first);
        CHECK(*std::ranges::max_element(seam.at) <= window.last - n);
        CHECK(seam.energy == Approx(cost(state, seam.at)));
        state.remove(seam.at);
    }
    CHECK(found.wall_s.size() == 8);
}

TEST_CASE(
    "insertions are removals in original places: distinct, never the last entry, feasible when "
    "sorted") {
    const ColumnSizes shape{6, 5, 3};
    auto removals = noise({9, 6, 5}, Axis::u, 3, 4), insertions = noise({9, 6, 5}, Axis::u, 3, 4);
    const auto removed = find_seams(removals, {Seams::Kind::remove, {0, 7}}, 8, greedy(16), nobody);
    const auto inserted =
        find_seams(insertions, {Seams::Kind::insert, {0, 8}}, 8, greedy(16), nobody);
    std::vector<std::vector<std::uint16_t>> ranked(
        8, std::vector<std::uint16_t>(removed.seams[0].at.size()));
    for (std::size_t c = 0; c < removed.seams[0].at.size(); ++c) {
        std::vector<std::uint16_t> left{0, 1, 2, 3, 4, 5, 6, 7, 8}, taken;
        for (std::size_t n = 0; n < 8; ++n) {
            const auto place = left.begin() + removed.seams[n].at[c];
            REQUIRE(inserted.seams[n].at[c] == *place);
            REQUIRE(*place != 8);
            taken.push_back(*place);
            left.erase(place);
        }
        std::ranges::sort(taken);
        for (std::size_t n = 0; n < 8; ++n) ranked[n][c] = taken[n];
    }
    for (const auto& at : ranked) CHECK(shape.largest_jump(at) <= 1);
    for (std::size_t n = 0; n < 8; ++n) CHECK(inserted.seams[n].energy == removed.seams[n].energy);
}

TEST_CASE("more seams than fit are refused with the number that does") {
    auto energy = noise({12, 3, 3}, Axis::u, 1, 5);
    const auto fault = [&](Seams::Kind kind, int count, Window window) {
        return failure_of([&] { find_seams(energy, {kind, window}, count, greedy(16), nobody); });
    };
    CHECK(fault(Seams::Kind::remove, 9, {2, 9}) ==
          "9 seams do not fit: window [2, 9] has room to remove 8");
    CHECK(fault(Seams::Kind::insert, 9, {2, 9}) ==
          "9 seams do not fit: window [2, 9] has room to insert 8");
    CHECK(fault(Seams::Kind::insert, 12, {0, 11}) ==
          "12 seams do not fit: window [0, 11] has room to insert 11; a new vertex goes between "
          "two old ones, so none can follow the lattice's last vertex");
    CHECK(fault(Seams::Kind::insert, 1, {11, 11}) ==
          "1 seam does not fit: window [11, 11] has room to insert none; a new vertex goes between "
          "two old ones, so none can follow the lattice's last vertex");
    CHECK(find_seams(energy, {Seams::Kind::remove, {0, 11}}, 12, greedy(16), nobody).seams.size() ==
          12);
}

TEST_CASE("the number of threads changes no seam") {
    std::vector<FoundSeams> found;
    for (const std::size_t threads : {1, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        tbb::task_arena arena(static_cast<int>(threads));
        arena.execute([&] {
            auto energy = noise({40, 9, 11}, Axis::u, 4, 6);
            found.push_back(
                find_seams(energy, {Seams::Kind::insert, {0, 39}}, 5, greedy(16), nobody));
        });
    }
    for (std::size_t n = 0; n < 5; ++n) {
        CHECK(found[0].seams[n].at == found[1].seams[n].at);
        CHECK(found[0].seams[n].energy == found[1].seams[n].energy);
    }
}

TEST_CASE(
    "seams through a closed lattice close, with and without the Gaussian guide, in any window") {
    std::mt19937 random(11);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    for (unsigned n = 0; n < 1000; ++n) {
        const ColumnSizes shape{1 + below(6), 2 + below(12), 1 + below(4)};
        const int width = 2 + below(20), first = below(width);
        const Window window{first, first + below(width - first)};
        auto energy = noise({width, shape.laterals, shape.slices}, Axis::u,
                            static_cast<std::size_t>(shape.frames), n, true);
        const bool still = n % 5 == 0;
        std::vector<Seams::Seam> seams;
        for (const auto guide : {Guide::cone, Guide::gaussian}) {
            const auto find = [=](const EnergyVolume& part, Window window, int number,
                                  const Tick& tick) {
                return greedy_seam(part, window, number, 3, tick, guide);
            };
            auto copy = noise({width, shape.laterals, shape.slices}, Axis::u,
                              static_cast<std::size_t>(shape.frames), n, true);
            seams.push_back(
                find_seams(copy, {Seams::Kind::remove, window, still}, 1, find, nobody).seams[0]);
        }
        INFO("case " << n);
        for (const auto& seam : seams) {
            REQUIRE(shape.largest_jump(seam.at) <= 1);
            REQUIRE(shape.largest_gap(seam.at) <= 1);
            REQUIRE(*std::ranges::min_element(seam.at) >= window.first);
            REQUIRE(*std::ranges::max_element(seam.at) <= window.last);
            REQUIRE(seam.energy == Approx(cost(energy, seam.at)));
        }
    }
}

TEST_CASE(
    "the Gaussian guide keeps a seam near where it began, the cone alone lets it go as far as it "
    "can return") {
    // Each slice is a little cheaper one entry further up.
    const auto slope = [](std::size_t, std::size_t n) { return 100 - static_cast<float>(n % 40); };
    const auto energy = volume({40, 1, 30}, Axis::u, 1, slope, true);
    const auto highest = [&](Guide guide) {
        const auto seam = greedy_seam(energy, {0, 39}, 0, 1, nobody, guide);
        return *std::ranges::max_element(seam.at) - seam.at[0];
    };
    CHECK(highest(Guide::cone) == 15);
    CHECK(highest(Guide::gaussian) > 0);
    CHECK(highest(Guide::gaussian) < 8);
}

TEST_CASE(
    "a static seam is the same in all frames and follows the sum of their energy, finer than 16 "
    "bits") {
    const ColumnSizes shape{4, 5, 3};
    auto energy = noise({9, 4, 5}, Axis::u, 3, 8), left = noise({9, 4, 5}, Axis::u, 3, 8);
    const auto found =
        find_seams(energy, {Seams::Kind::remove, {0, 8}, true}, 3, greedy(9), nobody);
    for (const auto& seam : found.seams) {
        REQUIRE(seam.at.size() == 3 * 20);
        CHECK(std::equal(seam.at.begin(), seam.at.begin() + 40, seam.at.begin() + 20));
        CHECK(shape.largest_jump(seam.at) <= 1);
        CHECK(seam.energy == Approx(cost(left, seam.at)));
        left.remove(seam.at);
    }

    // Sums of 1000.25, 1000.125 and 1000.0625: one and the same code.
    auto close = volume({3, 1, 1}, Axis::u, 2, [](std::size_t t, std::size_t n) {
        return t == 0 ? 1000.0f : 0.25f / static_cast<float>(1u << n);
    });
    const auto finest =
        find_seams(close, {Seams::Kind::remove, {0, 2}, true}, 1, greedy(3), nobody).seams[0];
    CHECK(finest.at == std::vector<std::uint16_t>{2, 2});
    CHECK(finest.energy == 1000.0625);
}

TEST_CASE("a search stops when it is told to") {
    auto energy = noise({12, 3, 3}, Axis::u, 2, 5);
    CHECK_THROWS_AS(find_seams(energy, {Seams::Kind::remove, {0, 11}}, 3, greedy(16),
                               [](double fraction) {
                                   if (fraction > 0.3) throw Cancelled{};
                               }),
                    Cancelled);
}

namespace {

struct EntryListener : Context::Host {
    nlohmann::ordered_json entry;
    std::vector<std::string> warnings;
    void warn(const std::string& message) override { warnings.push_back(message); }
    void report(const std::string& section, const nlohmann::ordered_json& json) override {
        CHECK(section == "seams");
        entry = json;
    }
};

struct SolvedGreedily {
    Ref<Seams> seams;
    EntryListener listener;
};

/// Runs seam.greedy over frames 5 and 6, energy `value(voxel, t)` on voxels 0 to 7.
SolvedGreedily solve(const std::string& yaml, const std::function<float(const Coord&, int)>& value,
                     const Lattice& lattice = make_box(Vec3d(0), {8, 8, 8}, 1.0, {0, 1, 2})) {
    static const std::vector<int> frames{5, 6};
    SolvedGreedily out;
    const auto space = Payload(std::make_shared<Lattice>(lattice));
    NodeBench bench(seam_greedy(), yaml);
    for (std::size_t t = 0; t < 2; ++t) {
        const auto grid = FloatGrid::create();
        auto values = grid->getAccessor();
        for (auto at = CoordBBox(Coord(0), Coord(7)).begin(); at; ++at)
            values.setValueOn(*at, value(*at, int(t)));
        bench.add({{"energy", {Payload(grid)}}, {"lattice", {space}}},
                  Context(out.listener, frames).at(t));
    }
    out.seams = bench.gathered({{"lattice", {space}}}, Context(out.listener, frames))
                    .at("seams")
                    .as<Seams>();
    return out;
}

float wavy(const Coord& at, int t) {
    return float(1 + std::abs(at.x() - 3 - (at.z() + t) % 2) + at.y() % 2);
}

}  // namespace

TEST_CASE("seam.greedy finds seams over all frames and reports them") {
    const auto solved = solve("{count: -25%, axis: u}", wavy);
    CHECK(solved.seams->kind == Seams::Kind::remove);
    CHECK(solved.seams->frames == std::vector<int>{5, 6});
    CHECK(solved.seams->seams.size() == 2);
    CHECK(solved.seams->seams[0].energy == Approx(1.5 * 128));
    CHECK(solved.listener.entry["axis"] == "u");
    CHECK(solved.listener.entry["kind"] == "remove");
    CHECK(solved.listener.entry["shape"] == nlohmann::ordered_json({8, 8, 8, 2}));
    CHECK(solved.listener.entry["energy"].size() == 2);
    CHECK(solved.listener.entry["energy"][0] == solved.seams->seams[0].energy);
    CHECK(solved.listener.entry["wall_s"].size() == 2);
    CHECK(solved.listener.warnings.empty());
    CHECK(solved.listener.entry["zero_share"] == nlohmann::ordered_json({0.0, 0.0}));
    CHECK(solve("{count: 3, axis: v}", wavy).seams->kind == Seams::Kind::insert);
}

TEST_CASE("seam.greedy finds nothing for a count of nothing") {
    const auto solved = solve("{count: 0}", wavy);
    CHECK(solved.seams->seams.empty());
    CHECK(solved.seams->shape == std::array{8, 8, 8});
    CHECK(solved.listener.entry["energy"] == nlohmann::ordered_json::array());
}

TEST_CASE(
    "seam.greedy tells windows that do not fit, lattices that miss, and seams that cost nothing") {
    CHECK(failure_of([] { solve("{count: -1, window: [2, 8]}", wavy); }) ==
          "window [2, 8] leaves the lattice, which has 8 vertices along u: 0 to 7");
    CHECK(NodeBench(seam_greedy(), "{count: -1, window: [0.5, 3]}").faults() ==
          "window must be [first, last], whole vertices or shares of them such as [0%, 50%], not "
          "[0.5, 3]\n");
    CHECK(failure_of([] {
              solve("{count: -1}", wavy, make_box(Vec3d(20, 0, 0), {8, 8, 8}, 1.0, {0, 1, 2}));
          }) ==
          "the lattice misses the energy: its box of 8 x 8 x 8 vertices from (20, 0, 0) to (27, 7, "
          "7), spacing 1, axes xyz, but the active voxels span (0, 0, "
          "0) to (7, 7, 7); move the lattice (its rig, or `min` and `max`) or the data "
          "(`translate` and `scale` of its reader)");
    const auto idle =
        solve("{count: -6}", [](const Coord& at, int) { return at.x() > 4 ? 1.0f : 0.0f; });
    CHECK(idle.listener.entry["zero_share"] ==
          nlohmann::ordered_json({1.0, 1.0, 1.0, 1.0, 1.0, 0.0}));
    CHECK(idle.listener.warnings ==
          std::vector<std::string>{
              "5 of 6 seams take no energy at all, so that carving them may change nothing "
              "visible; `mask.weight` gives empty space an "
              "energy of its own, and `window: [first, last]` holds seams where the content is"});
    const auto half = solve("{count: -1, window: [3, 3]}", [](const Coord& at, int t) {
        return at.z() < 2 && t == 0 ? 0.0f : 1.0f;
    });
    CHECK(half.listener.entry["zero_share"] == nlohmann::ordered_json({0.125}));
    CHECK(half.listener.warnings.empty());
    CHECK(solve("{count: -1, window: [5, 7]}", [](const Coord& at, int) {
              return at.x() > 4 ? 1.0f : 0.0f;
          }).listener.warnings.empty());
}

TEST_CASE("an energy that is the same for all frames is asked for once") {
    static const std::vector<int> frames{5, 6, 7};
    EntryListener listener;
    const auto space =
        Payload(std::make_shared<Lattice>(make_box(Vec3d(0), {8, 8, 8}, 1.0, {0, 1, 2})));
    const auto grid = FloatGrid::create();
    for (auto at = CoordBBox(Coord(0), Coord(7)).begin(); at; ++at)
        grid->tree().setValueOn(*at, wavy(*at, 0));
    NodeBench bench(seam_greedy(), "{count: -1}");
    const NodeBench::Inputs inputs{{"energy", {Payload(grid)}}, {"lattice", {space}}};
    bench.add(inputs, Context(listener, frames));
    const auto seams = bench.gathered(inputs, Context(listener, frames)).at("seams").as<Seams>();
    const auto& at = seams->seams[0].at;
    REQUIRE(at.size() == 3 * 64);
    CHECK(std::equal(at.begin(), at.begin() + 64, at.begin() + 128));
    CHECK(seams->seams[0].energy == Approx(1.5 * 3 * 64));
}
