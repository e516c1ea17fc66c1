#include "nodes/lattice/mapping.h"
#include "nodes/mask/sphere.h"
#include "nodes/payloads.h"
#include "nodes/remap/remap.h"
#include "nodes/seam/cut_seam.h"
#include "nodes/seam/dynamic.h"
#include "nodes/seam/energy_slab.h"
#include "nodes/seam/find_seams.h"
#include "nodes/seam/graph_cut_node.h"
#include "nodes/seam/greedy.h"
#include "nodes/seam/greedy_node.h"
#include "nodes/seam/lower_bound.h"
#include "nodes/seam/marks.h"
#include "nodes/seam/protection.h"
#include "nodes/seam/pyramid.h"
#include "nodes/seam/pyramid_node.h"
#include "nodes/seam/strip.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/brute_force.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"

#include <openvdb/io/File.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// Protected and attracted vertices, against all seams of tiny volumes; masks on lattices; energies by volume.

namespace {

const Tick nobody = [](double) {};
const auto quiet = [] {};

FindSeam greedy(int starts) {
    return [=](const EnergyVolume& energy, Window window, int number, const Tick& tick) { return greedy_seam(energy, window, number, starts, tick); };
}

/// What a protected vertex costs the oracle: more than all energies of a tiny volume.
constexpr double blocked = 1e9;

std::uint16_t& code_at(EnergyVolume& energy, std::size_t c, int entry) {
    return energy.slab(c / energy.columns_per_frame())[c % energy.columns_per_frame() * energy.stride() + static_cast<std::size_t>(entry)];
}

/// Marks entries at random. @param guarded, wanted  percent of them
void mark(std::mt19937& random, EnergyVolume& energy, int guarded, int wanted) {
    for (std::size_t t = 0; t < energy.frames(); ++t)
        for (auto& code : energy.slab(t)) {
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
        for (const auto code : energy.slab(t))
            if (code <= highest_energy_code) highest = std::max(highest, decode_energy(code));
    return [&energy, attraction = 64.0 * (highest > 0 ? highest : 1)](std::size_t c, int entry) -> double {
        const auto code = code_at(energy, c, entry);
        return code == protected_code ? blocked : code == attracted_code ? -attraction : decode_energy(code);
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

    Puzzle(std::mt19937& random, const std::array<int, 3>& size, bool closed, int guarded, int wanted)
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

/// Calls back with puzzles of lines, planes, volumes and sequences, open and closed, that have few free vertices or many.
template <class Call>
void for_puzzles(unsigned seed, int count, int wanted, const Call& call) {
    std::mt19937 random(seed);
    for (int n = 0; n < count; ++n) {
        Puzzle puzzle(random, random_size(random, 12), n % 2 == 0, 10 + below(random, 60), n % 3 == 0 ? wanted : 0);
        INFO("case " << n);
        call(puzzle, n);
    }
}

FloatGrid::Ptr energy_grid(const CoordBBox& box, const std::function<float(const Coord&)>& value) {
    const auto out = FloatGrid::create();
    auto values = out->getAccessor();
    for (auto at = box.begin(); at; ++at) values.setValueOn(*at, value(*at));
    return out;
}

MaskGrid::Ptr mask_grid(const std::vector<Coord>& voxels) {
    const auto out = MaskGrid::create();
    for (const auto& voxel : voxels) out->tree().setValueOn(voxel);
    return out;
}

struct Listener : Context::Host {
    nlohmann::ordered_json entry;
    std::vector<std::string> warnings;
    void warn(const std::string& message) override { warnings.push_back(message); }
    void report(const std::string&, const nlohmann::ordered_json& json) override { entry = json; }
};

struct Solved {
    Ref<Seams> seams;
    Listener listener;
};

using Masks = std::map<std::string, std::vector<openvdb::GridBase::ConstPtr>>;

/// Runs a solver over frames 5, 6 ...; one energy for all frames or one for each, masks by input likewise.
Solved solve(NodeType type, const std::string& yaml, const std::vector<FloatGrid::Ptr>& energy, const std::vector<Lattice>& lattices, const Masks& masks,
             std::size_t frame_count, const std::vector<Ref<Seams>>& after = {}) {
    std::vector<int> frames;
    for (std::size_t t = 0; t < frame_count; ++t) frames.push_back(5 + static_cast<int>(t));
    Solved out;
    NodeBench bench(std::move(type), yaml);
    REQUIRE(bench.faults() == "");
    NodeBench::Inputs still;
    for (const auto& seams : after) still["after"].push_back(Payload(seams));
    const auto of = [](const auto& list, std::size_t t) { return list[std::min(t, list.size() - 1)]; };
    auto adds = std::max(energy.size(), lattices.size());
    for (const auto& [name, grids] : masks) adds = std::max(adds, grids.size());
    for (std::size_t t = 0; t < adds; ++t) {
        auto inputs = still;
        inputs["energy"] = {Payload(of(energy, t))};
        inputs["lattice"] = {Payload(std::make_shared<Lattice>(of(lattices, t)))};
        for (const auto& [name, grids] : masks) inputs[name] = {Payload(std::make_shared<AnyGrid>(AnyGrid{of(grids, t)}))};
        Context context(out.listener, frames);
        bench.add(inputs, adds == 1 ? context : context.at(t));
    }
    out.seams = bench.gathered(still, Context(out.listener, frames)).at("seams").as<Seams>();
    return out;
}

Lattice box(const std::array<int, 3>& shape) { return make_box(Vec3d(0), shape, 1.0, {0, 1, 2}); }

}  // namespace

TEST_CASE("codes of marks lie above all energies and below what is none") {
    CHECK(highest_energy_code < protected_code);
    CHECK(std::set{highest_energy_code, protected_code, attracted_code, invalid_energy_code}.size() == 4);
    CHECK(encode_energy(decode_energy(highest_energy_code)) == highest_energy_code);
    CHECK(encode_energy(std::nextafter(decode_energy(protected_code), 0.0f)) == invalid_energy_code);
}

TEST_CASE("exact seams pass no protected vertex, take attracted ones, and cost the least of all that do") {
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
        const auto seam = dynamic_seam(puzzle.energy, puzzle.window, n, nobody);
        REQUIRE(puzzle.free(seam.at));
        REQUIRE(Puzzle::sum(seam.at, puzzle.cost) == puzzle.want.cost);
        REQUIRE(seam.energy == Puzzle::sum(seam.at, plain_energies(puzzle.energy)));
    }
    CHECK(possible > 400);
}

TEST_CASE("static seams pass no vertex that is protected in any frame, and add up attraction over the frames") {
    std::mt19937 random(3);
    int possible = 0;
    for (int n = 0; n < 600; ++n) {
        const auto size = random_size(random, 8);
        const int frames = 2 + below(random, 3), width = 1 + below(random, 6);
        const ColumnGraph all({size[0], size[1], frames}, n % 2 == 0), frame({size[0], size[1], 1}, n % 2 == 0);
        auto energy = random_volume(random, all, width);
        mark(random, energy, 5 + below(random, 20), 10);
        const auto each = costs_of(energy), plain = plain_energies(energy);
        const auto over_frames = [&](const CostAt& of) {
            return [&of, &frame, frames](std::size_t c, int entry) {
                double out = 0;
                for (int t = 0; t < frames; ++t) out += of(c + frame.count() * static_cast<std::size_t>(t), entry);
                return out;
            };
        };
        const Window window{0, width - 1};
        const auto band = Band::whole(frame.count(), window);
        const auto want = brute_force(frame, band, over_frames(each));
        INFO("case " << n);
        if (want.cost > blocked / 2) {
            REQUIRE_THROWS_AS(find_seams(energy, Seams::Kind::remove, 1, window, greedy(16), nobody, nullptr, true), NoSeam);
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
        for (std::size_t c = 0; c < all.count(); ++c) attracted += code_at(energy, c, quick.at[c % frame.count()]) == attracted_code;
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
                const auto seam = greedy_seam(puzzle.energy, puzzle.window, n, starts, nobody, guide);
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
        const auto seam = keyframed_seam(puzzle.energy, puzzle.window, n, 1 + n % 2, n % 4 == 0 ? 2 : 0, quiet);
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
            for (int entry = puzzle.window.first; entry <= puzzle.window.last; ++entry) free[c] += code_at(puzzle.energy, c, entry) != protected_code;
        const bool possible = puzzle.possible();
        try {
            find_seams(puzzle.energy, Seams::Kind::remove, 1, puzzle.window, greedy(16), nobody);
            REQUIRE(possible);
        } catch (const NoSeam& none) {
            REQUIRE(!possible);
            ++impossible;
            CHECK(none.found == 0);
            CHECK(none.at.vertices == puzzle.window.size());
            CHECK(none.at.free == free.at(none.at.column));
            const auto first = std::ranges::find(free, 0);
            if (first != free.end()) CHECK(none.at.column == static_cast<std::size_t>(first - free.begin()));
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
        const ColumnGraph graph({1 + below(random, 3), 1 + below(random, 3), 1 + below(random, 2)}, n % 2 == 0);
        auto energy = random_volume(random, graph, 7), left = random_volume(random, graph, 7);
        mark(random, energy, 25, 10);
        for (std::size_t t = 0; t < energy.frames(); ++t) std::ranges::copy(energy.slab(t), left.slab(t).begin());
        const auto find = [&](const EnergyVolume& now, Window window, int number, const Tick&) { return exact_seam(now, window, number, quiet); };
        INFO("case " << n);
        std::vector<Seams::Seam> seams;
        int possible = 4;
        try {
            const auto found = find_seams(energy, Seams::Kind::remove, 4, {1, 6}, find, nobody);
            for (std::size_t s = 0; s < 4; ++s) {
                const auto cost = costs_of(left);
                REQUIRE(Puzzle::sum(found.seams[s].at, cost) < blocked / 2);
                REQUIRE(found.blocked[s] == 0);
                std::size_t attracted = 0;
                for (std::size_t c = 0; c < graph.count(); ++c) attracted += cost(c, found.seams[s].at[c]) < 0;
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
        for (std::size_t t = 0; t < again.frames(); ++t) std::ranges::copy(left.slab(t), again.slab(t).begin());
        again.find_marks();
        const auto found = find_seams(again, Seams::Kind::remove, possible, {1, 6}, find, nobody);
        for (const auto& seam : found.seams) left.remove(seam.at);
        REQUIRE(brute_force(graph, Band::whole(graph.count(), {1, 6 - possible}), costs_of(left)).cost > blocked / 2);
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
        // All seams on one side are the same for an oracle that likes each entry best that is nearest to the seam.
        ++moved;
        const auto nearest = [&](int side) {
            return brute_force(puzzle.graph, puzzle.band, [&](std::size_t c, int entry) {
                if (puzzle.cost(c, entry) > blocked / 2 || (entry - seam[c]) * side < 0) return blocked;
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
        if (costs.size() == 2) REQUIRE(Puzzle::sum(got, puzzle.cost) == std::min(costs[0], costs[1]));
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

/// So large that the pyramid does not cut it as a whole; all is protected but a hidden seam and some vertices at random.
EnergyVolume maze(std::mt19937& random, const ColumnGraph& graph, int width, int guarded) {
    const auto hidden = random_seam(random, graph, {width / 4, 3 * width / 4});
    auto out = random_volume(random, graph, width);
    for (std::size_t c = 0; c < graph.count(); ++c)
        for (int entry = 0; entry < width; ++entry)
            if (entry != hidden[c] && below(random, 100) < guarded) code_at(out, c, entry) = protected_code;
    out.find_marks();
    return out;
}

}  // namespace

TEST_CASE("the pyramid finds the way through large mazes, as the greedy search does, and never a dearer one") {
    std::mt19937 random(10);
    for (int n = 0; n < 9; ++n) {
        const ColumnGraph graph(n % 3 == 0 ? std::array{60, 70, 1} : n % 3 == 1 ? std::array{18, 20, 12} : std::array{1, 201, 21}, n % 2 == 0);
        const Window window{2, 67};
        const auto energy = maze(random, graph, 70, std::array{30, 70, 99}[static_cast<std::size_t>(n / 3)]);
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

TEST_CASE("the pyramid takes an attracted ball in as many seams as it is high, in one frame of energies or their sum") {
    std::mt19937 random(11);
    for (const bool still : {false, true}) {
        const ColumnGraph graph({40, 30, 4});
        auto energy = random_volume(random, graph, 64);
        std::size_t total = 0;
        for (std::size_t c = 0; c < graph.count(); ++c)
            for (int entry = 0; entry < 64; ++entry) {
                const int x = entry - 40, y = static_cast<int>(c % 40) - 17, z = static_cast<int>(c / 40 % 30) - 12;
                if (x * x + y * y + z * z > 16) continue;
                code_at(energy, c, entry) = attracted_code;
                ++total;
            }
        energy.find_marks();
        CHECK(energy.attracted() == total);
        const auto found = find_seams(energy, Seams::Kind::remove, 10, {0, 63}, Pyramid(Quality::normal, 16), nobody, nullptr, still);
        std::size_t taken = 0;
        for (const auto n : found.attracted) taken += n;
        CHECK(taken == total);
        CHECK(found.attracted_left == 0);
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

namespace {

/// Which vertices a mask marks, in the order of a slab.
std::vector<bool> marked(const openvdb::GridBase& mask, const Lattice& lattice, Axis axis = Axis::u) {
    std::vector<std::uint16_t> slab(static_cast<std::size_t>(lattice.shape[0]) * static_cast<std::size_t>(lattice.shape[1]) *
                                    static_cast<std::size_t>(lattice.shape[2]));
    const auto count = mark_vertices(mask, lattice, axis, protected_code, slab);
    CHECK(count == static_cast<std::size_t>(std::ranges::count(slab, protected_code)));
    std::vector<bool> out;
    for (const auto code : slab) out.push_back(code == protected_code);
    return out;
}

/// From the definition: whether one of the voxels around a place in index space is set.
bool set_around(const MaskGrid& mask, const Vec3d& at) {
    for (int n = 0; n < 8; ++n) {
        Coord voxel;
        for (int d = 0; d < 3; ++d) {
            const double whole = std::round(at[d]), place = std::abs(at[d] - whole) <= 1e-5 ? whole : at[d];
            voxel[d] = static_cast<int>(n >> d & 1 ? std::ceil(place) : std::floor(place));
        }
        if (mask.tree().isValueOn(voxel)) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("a vertex on a voxel counts where that voxel is set, one between voxels where any of those around it is") {
    const auto mask = mask_grid({Coord(2, 3, 1)});
    const auto count = [&](const Vec3d& first, double spacing) {
        const auto set = marked(*mask, make_box(first, {8, 8, 8}, spacing, {0, 1, 2}));
        return std::ranges::count(set, true);
    };
    CHECK(count(Vec3d(0), 1) == 1);
    CHECK(count(Vec3d(1e-7, 0, 0), 1) == 1);
    CHECK(count(Vec3d(0.5, 0, 0), 1) == 2);
    CHECK(count(Vec3d(0.5, 0, 0.1), 1) == 4);
    CHECK(count(Vec3d(0.5, 0.9, 0.1), 1) == 8);
    // Less than a voxel from the set one, on both sides.
    CHECK(count(Vec3d(0), 0.5) == 27);
    CHECK(count(Vec3d(0, 1, 1), 2) == 1);
    CHECK(count(Vec3d(1, 0, 0), 2) == 0);

    const auto on = marked(*mask, box({4, 5, 6}));
    for (std::size_t n = 0; n < on.size(); ++n) CHECK(on[n] == (n == 2 + 4 * (3 + 5 * 1)));
    const auto along_v = marked(*mask, box({4, 5, 6}), Axis::v);
    for (std::size_t n = 0; n < along_v.size(); ++n) CHECK(along_v[n] == (n == 3 + 5 * (2 + 4 * 1)));
}

TEST_CASE("masks are seen from bent lattices and through their transform, tiles too") {
    std::mt19937 random(13);
    for (int n = 0; n < 20; ++n) {
        const auto lattice = n % 4 == 0 ? make_box(Vec3d(-2.1, 3.3, 1.7), {9, 8, 7}, 0.7, {2, 0, 1}) : random_bent(random, n % 2 == 0);
        const auto mask = MaskGrid::create();
        mask->setTransform(openvdb::math::Transform::createLinearTransform(n % 3 == 0 ? 0.4 : 1.1));
        CoordBBox reach;
        for (int k = 0; k < lattice.shape[2]; ++k)
            for (const int i : {0, lattice.shape[0] - 1})
                for (const int j : {0, lattice.shape[1] - 1}) reach.expand(Coord::round(mask->worldToIndex(lattice.position(Vec3d(i, j, k)))));
        for (int voxels = 0; voxels < 2000; ++voxels) {
            Coord at;
            for (int d = 0; d < 3; ++d) at[d] = reach.min()[d] + below(random, reach.dim()[d]);
            mask->tree().setValueOn(at);
        }
        mask->tree().addTile(1, reach.getStart().offsetBy(reach.dim().x() / 2, 0, 0), true, true);
        const auto set = marked(*mask, lattice);
        std::size_t place = 0, count = 0, wrong = 0;
        for (int k = 0; k < lattice.shape[2]; ++k)
            for (int j = 0; j < lattice.shape[1]; ++j)
                for (int i = 0; i < lattice.shape[0]; ++i, ++place) {
                    const bool want = set_around(*mask, mask->worldToIndex(lattice.position(Vec3d(i, j, k))));
                    count += want;
                    wrong += set[place] != want;
                }
        INFO("case " << n);
        CHECK(wrong == 0);
        CHECK(count > 0);
    }
}

TEST_CASE("the active voxels of any grid are a mask, whatever their value; points are none") {
    const auto lattice = box({4, 4, 4});
    const auto want = marked(*mask_grid({Coord(1, 2, 3)}), lattice);
    const auto check = [&](auto grid) {
        grid->tree().setValueOn(Coord(1, 2, 3), openvdb::zeroVal<typename std::decay_t<decltype(*grid)>::ValueType>());
        CHECK(marked(*grid, lattice) == want);
    };
    check(FloatGrid::create(7));
    check(VectorGrid::create());
    check(openvdb::BoolGrid::create());
    check(openvdb::Int32Grid::create());
    auto level_set = FloatGrid::create(3);
    level_set->setGridClass(openvdb::GRID_LEVEL_SET);
    check(level_set);
    auto points = openvdb::points::PointDataGrid::create();
    points->setName("drops");
    CHECK(failure_of([&] { marked(*points, lattice); }) ==
          "grid 'drops' is of type Tree_ptdataidx32_5_4_3, which is no mask; make one of a field, by mask.threshold");
}

TEST_CASE("masks are taken frame by frame or once for all, and what is protected is not attracted") {
    const auto flat = energy_grid(CoordBBox(Coord(0), Coord(5, 0, 0)), [](const Coord&) { return 1.0f; });
    const auto run = [&](const std::string& yaml, const Masks& masks) { return solve(seam_graph_cut(), yaml, {flat}, {box({6, 1, 1})}, masks, 3); };
    const auto at = [](const Solved& solved) {
        const auto entries = solved.seams->seams[0].at.all();
        return std::vector<int>(entries.begin(), entries.end());
    };
    const auto one = mask_grid({Coord(3, 0, 0)}), next = mask_grid({Coord(4, 0, 0)}), other = mask_grid({Coord(5, 0, 0)});
    CHECK(at(run("{count: -1}", {{"attract", {one}}})) == std::vector{3, 3, 3});
    const auto moving = run("{count: -1}", {{"attract", {one, next, other}}});
    CHECK(at(moving) == std::vector{3, 4, 5});
    CHECK(moving.listener.entry["attracted"] == nlohmann::json({3}));
    CHECK(moving.listener.entry["energy"] == nlohmann::json({0.0}));
    CHECK(!moving.listener.entry.contains("protected"));
    CHECK(at(run("{count: -1}", {{"attract", {one, next, other}}, {"protect", {mask_grid({Coord(3, 0, 0), Coord(5, 0, 0)})}}})) == std::vector{4, 4, 4});

    const auto guarded = mask_grid({Coord(0, 0, 0), Coord(1, 0, 0), Coord(2, 0, 0), Coord(3, 0, 0), Coord(5, 0, 0)});
    const auto past = run("{count: -1}", {{"protect", {guarded}}});
    CHECK(at(past) == std::vector{4, 4, 4});
    CHECK(past.listener.entry["protected"] == nlohmann::json({0}));
    CHECK(past.listener.entry["energy"] == nlohmann::json({3.0}));
    CHECK(past.listener.warnings.empty());
    // Inserted vertices double none that is protected.
    CHECK(at(run("{count: 1}", {{"protect", {guarded}}})) == std::vector{4, 4, 4});
    const auto pairs = run("{count: -1, window: [0, 2], pair_window: [3, 5]}", {{"protect", {mask_grid({Coord(0, 0, 0), Coord(2, 0, 0), Coord(3, 0, 0)})}}});
    CHECK(at(pairs) == std::vector{1, 1, 1});
    CHECK(pairs.seams->pairs[0].at == SeamEntries{4, 4, 4});
    CHECK(pairs.listener.entry["pair_protected"] == nlohmann::json({0}));
}

TEST_CASE("a mask that misses the lattice, and attraction that seams do not reach, are warned of") {
    const auto flat = energy_grid(CoordBBox(Coord(0), Coord(5, 0, 0)), [](const Coord&) { return 1.0f; });
    const auto run = [&](const std::string& yaml, const Masks& masks) {
        return solve(seam_graph_cut(), yaml, {flat}, {box({6, 1, 1})}, masks, 1).listener.warnings;
    };
    CHECK(run("{count: -1}", {{"protect", {mask_grid({Coord(9, 0, 0)})}}}) ==
          std::vector<std::string>{"`protect` is set around no vertex of the lattice: nothing is protected"});
    CHECK(run("{count: -1}", {{"attract", {mask_grid({})}}}) ==
          std::vector<std::string>{"`attract` is set around no vertex of the lattice: nothing is attracted"});
    CHECK(run("{count: -2, window: [0, 2]}", {{"attract", {mask_grid({Coord(2, 0, 0), Coord(4, 0, 0)})}}}) ==
          std::vector<std::string>{"1 of 2 seams take nothing of `attract`, though some of it is left: it is out of their window, or the way there too long; "
                                   "seam.greedy sees only what is beside its way, other solvers all"});
    CHECK(run("{count: -2}", {{"attract", {mask_grid({Coord(2, 0, 0), Coord(4, 0, 0)})}}}).empty());
    CHECK(run("{count: -3}", {{"attract", {mask_grid({Coord(2, 0, 0), Coord(4, 0, 0)})}}}).empty());
}

TEST_CASE("masks travel with what earlier seams carved; a new vertex is marked if either neighbour is") {
    std::mt19937 random(14);
    const std::vector<int> frames{5, 6, 7};
    const Layout layout{Coord(0), {Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)}};
    for (int n = 0; n < 30; ++n) {
        const auto lattice = box({8 + below(random, 6), 8 + below(random, 6), 1 + below(random, 4)});
        const CoordBBox space(Coord(0), Coord(lattice.shape[0] - 1, lattice.shape[1] - 1, lattice.shape[2] - 1));
        std::vector<Ref<Seams>> after;
        auto shape = lattice.shape;
        for (int step = 0; step < 1 + n % 3; ++step) {
            const auto axis = random() % 2 == 0 ? Axis::u : Axis::v;
            const auto kind = random() % 2 == 0 ? Seams::Kind::remove : Seams::Kind::insert;
            const auto make = random() % 2 == 0 ? random_pairs : random_seams;
            after.push_back(std::make_shared<Seams>(make(random, lattice, shape, axis, kind, below(random, 3), frames)));
            shape = after.back()->shape_after(after.back()->seams.size());
        }
        // Everything that only one of many carved spaces shows: energies, and masks of few voxels.
        std::vector<FloatGrid::Ptr> energy, carved;
        Masks masks, carved_masks;
        for (std::size_t t = 0; t < frames.size(); ++t) {
            energy.push_back(energy_grid(space, [&](const Coord&) { return static_cast<float>(below(random, 64)); }));
            const auto mean = [](const auto& a, const auto& b) { return Dense<float>::Voxel{0.5f * (a.value + b.value), true}; };
            const auto either = [](const auto& a, const auto& b) { return Dense<float>::Voxel{std::max(a.value, b.value), true}; };
            const auto carve_all = [&](const FloatGrid& grid, const auto& between) {
                Dense<float> dense(grid, CoordBBox(Coord(0), Coord(23, 23, 8)));
                for (const auto& set : after) carve(dense, layout, *set, t, set->seams.size(), 0.0f, between);
                return dense;
            };
            const CoordBBox left(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1));
            auto dense = carve_all(*energy.back(), mean);
            carved.push_back(energy_grid(left, [&](const Coord& at) { return dense.at(at).value; }));
            // Nothing is both: where neighbours are marked otherwise, protection comes first.
            const auto guarded = energy_grid(space, [&](const Coord&) { return below(random, 12) == 0 ? 1.0f : 0.0f; });
            const auto wanted = energy_grid(space, [&](const Coord& at) { return guarded->tree().getValue(at) == 0 && below(random, 12) == 0 ? 1.0f : 0.0f; });
            for (const auto& [name, grid] : {std::pair("protect", guarded), std::pair("attract", wanted)}) {
                auto set = carve_all(*grid, either);
                std::vector<Coord> before, now;
                for (auto at = space.begin(); at; ++at)
                    if (grid->tree().getValue(*at) > 0) before.push_back(*at);
                for (auto at = left.begin(); at; ++at)
                    if (set.at(*at).value > 0) now.push_back(*at);
                masks[name].push_back(mask_grid(before));
                carved_masks[name].push_back(mask_grid(now));
            }
        }
        const std::string yaml = n % 2 ? "{count: -2, axis: u, window: [1, 4]}" : "{count: 2, axis: v}";
        const auto run = [&](const auto& energies, const Lattice& in, const Masks& marks, const std::vector<Ref<Seams>>& sets) -> std::optional<Solved> {
            try {
                return solve(seam_graph_cut(), yaml, energies, {in}, marks, 3, sets);
            } catch (const Failure& failure) {
                REQUIRE(std::string(failure.what()).find("possible in window") != std::string::npos);
                return std::nullopt;
            }
        };
        const auto got = run(energy, lattice, masks, after), want = run(carved, box(shape), carved_masks, {});
        INFO("case " << n);
        REQUIRE(got.has_value() == want.has_value());
        if (!got) continue;
        REQUIRE(got->seams->seams.size() == want->seams->seams.size());
        for (std::size_t s = 0; s < got->seams->seams.size(); ++s) CHECK(got->seams->seams[s].at == want->seams->seams[s].at);
        CHECK(got->listener.entry["attracted"] == want->listener.entry["attracted"]);
    }
}

TEST_CASE("seams that run out say how many are possible, and where and when there is no way") {
    // Behind x = 3 all is protected in frame 6 at (y, z) = (1, 2); in front of it three vertices are free.
    const CoordBBox space(Coord(0), Coord(7, 2, 3));
    const auto flat = energy_grid(space, [](const Coord&) { return 1.0f; });
    std::vector<Coord> wall;
    for (int x = 3; x < 8; ++x) wall.emplace_back(x, 1, 2);
    const Masks masks{{"protect", {mask_grid({}), mask_grid(wall), mask_grid({})}}};
    const auto failure = [&](NodeType type, const std::string& yaml, const std::vector<Lattice>& lattices, const Masks& marks,
                             const std::vector<Ref<Seams>>& after = {}) {
        return failure_of([&] { solve(std::move(type), yaml, {flat}, lattices, marks, 3, after); });
    };
    const std::string told =
        "3 of 5 seams are possible in window [0, 7]: in frame 6 column (0 to 7, 1, 2), from (0, 1, 2) to (7, 1, 2), has no unprotected vertex left; "
        "ask for fewer, widen the window or protect less";
    for (const auto& type : {seam_greedy(), seam_pyramid(), seam_graph_cut()}) CHECK(failure(type, "{count: -5}", {box({8, 3, 4})}, masks) == told);
    CHECK(solve(seam_pyramid(), "{count: -3}", {flat}, {box({8, 3, 4})}, masks, 3).seams->seams.size() == 3);
    CHECK(failure(seam_greedy(), "{count: 4}", {box({8, 3, 4})}, masks) ==
          "3 of 4 seams are possible in window [0, 7]: in frame 6 column (0 to 6, 1, 2), from (0, 1, 2) to (6, 1, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less");
    CHECK(failure(seam_greedy(), "{count: -2, static: true, window: [2, 5]}", {box({8, 3, 4})}, masks) ==
          "1 of 2 seams is possible in window [2, 5]: over all frames column (2 to 5, 1, 2), from (2, 1, 2) to (5, 1, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less");
    CHECK(failure(seam_greedy(), "{count: 1, window: [0, 2], pair_window: [4, 6]}", {box({8, 3, 4})}, masks) ==
          "no seam is possible in pair_window [4, 6]: in frame 6 column (4 to 6, 1, 2), from (4, 1, 2) to (6, 1, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less");
    // Along v, in a lattice that moves.
    const auto moved = make_box(Vec3d(0, 0, 2), {8, 3, 2}, 1.0, {0, 1, 2});
    const Masks across{{"protect", {mask_grid({Coord(4, 0, 2), Coord(4, 1, 2), Coord(4, 2, 2)})}}};
    CHECK(failure(seam_greedy(), "{count: -1, axis: v}", {box({8, 3, 2}), moved, moved}, across) ==
          "no seam is possible in window [0, 2]: in frame 6 column (4, 0 to 2, 0), from (4, 0, 2) to (4, 2, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less");
    // Free vertices that a seam would have to jump to.
    std::vector<Coord> gaps;
    for (int x = 0; x < 8; ++x) {
        if (x != 1) gaps.emplace_back(x, 0, 0);
        if (x != 4) gaps.emplace_back(x, 1, 0);
    }
    CHECK(
        failure(seam_greedy(), "{count: -1}", {box({8, 3, 4})}, {{"protect", {mask_grid(gaps)}}}) ==
        "no seam is possible in window [0, 7]: in frame 5 of the 8 vertices left in column (0 to 7, 0, 0), from (0, 0, 0) to (7, 0, 0), 1 is unprotected, but "
        "out of reach from the columns beside; ask for fewer, widen the window or protect less");
    // Places are those of the lattice, not of what earlier seams left.
    Seams before;
    before.shape = {8, 3, 4};
    before.frames = {5, 6, 7};
    before.lattice_hash = box({8, 3, 4}).hash;
    before.seams = {{std::vector<std::uint16_t>(36, 0)}, {std::vector<std::uint16_t>(36, 0)}};
    CHECK(failure(seam_greedy(), "{count: -5}", {box({8, 3, 4})}, masks, {std::make_shared<Seams>(before)}) ==
          "1 of 5 seams is possible in window [0, 5]: in frame 6 column (0 to 5, 1, 2), from (2, 1, 2) to (7, 1, 2), has no unprotected vertex left; "
          "ask for fewer, widen the window or protect less");
}

namespace {

std::vector<std::uint16_t> sampled(const FloatGrid& grid, const Lattice& lattice, Axis axis, Measure measure) {
    std::vector<std::uint16_t> out(static_cast<std::size_t>(lattice.shape[0]) * static_cast<std::size_t>(lattice.shape[1]) *
                                   static_cast<std::size_t>(lattice.shape[2]));
    sample_energy(grid, lattice, axis, out, measure);
    return out;
}

}  // namespace

TEST_CASE("by volume, a ring's vertices weigh as much as their distance from the axis") {
    const int planes = 90;
    const auto lattice = ring(Vec3d(30, 30, 10), {13, 4, planes}, 1.0, openvdb::Vec2d(-6, -2));
    const auto flat = energy_grid(CoordBBox(Coord(0), Coord(60, 60, 20)), [](const Coord&) { return 2.0f; });
    const double radius = ring_radius(planes, 1.0);
    for (const auto axis : {Axis::u, Axis::v}) {
        const auto plain = sampled(*flat, lattice, axis, Measure::vertex), weighed = sampled(*flat, lattice, axis, Measure::volume);
        for (int k = 0; k < planes; ++k)
            for (int j = 0; j < 4; ++j)
                for (int i = 0; i < 13; ++i) {
                    const auto place = static_cast<std::size_t>(axis == Axis::u ? (k * 4 + j) * 13 + i : (k * 13 + i) * 4 + j);
                    REQUIRE(decode_energy(plain[place]) == 2);
                    // Codes round to 5e-4; a ring of planes is a polygon, 6e-4 smaller.
                    REQUIRE(decode_energy(weighed[place]) == Approx(2 * (1 + (i - 6) / radius)).epsilon(1.2e-3));
                }
    }
    // A seam along v, and its energy, are by volume too: it costs as much as the space that it takes.
    const auto solved = solve(seam_pyramid(), "{count: -1, axis: v, measure: volume}", {flat}, {lattice}, {}, 1);
    CHECK(solved.listener.entry["energy"][0].get<double>() == Approx(2.0 * 13 * planes).epsilon(1.2e-3));
    const auto vertices = solve(seam_pyramid(), "{count: -1, axis: v}", {flat}, {lattice}, {}, 1);
    CHECK(vertices.listener.entry["energy"][0].get<double>() == Approx(2.0 * 13 * planes).epsilon(1e-6));
    // The innermost seam across u is the shortest way around.
    const auto inner = solve(seam_pyramid(), "{count: -1, measure: volume}", {flat}, {lattice}, {}, 1);
    CHECK(std::ranges::all_of(inner.seams->seams[0].at, [](int entry) { return entry == 0; }));
    CHECK(inner.listener.entry["energy"][0].get<double>() == Approx(2 * (1 - 6 / radius) * 4 * planes).epsilon(1.2e-3));
}

TEST_CASE("by volume, what is further apart than a spacing is averaged, not stepped over") {
    // A narrow ring: outside its planes are more than three spacings apart. Thin sheets through the axis are dear.
    const int planes = 12;
    const auto lattice = ring(Vec3d(15, 15, 5), {7, 1, planes}, 1.0, openvdb::Vec2d(0, 0));
    const auto stripes = energy_grid(CoordBBox(Coord(0), Coord(30, 30, 10)), [](const Coord& at) { return at.x() % 3 == 0 ? 3.0f : 0.0f; });
    const auto weighed = sampled(*stripes, lattice, Axis::u, Measure::volume);
    double got = 0, stepped = 0, want = 0;
    for (int k = 0; k < planes; ++k)
        for (int i = 4; i < 7; ++i) {
            got += decode_energy(weighed[static_cast<std::size_t>(k * 7 + i)]);
            // The integral over each cell's arc, finely.
            const double volume = (1 + i / ring_radius(planes, 1.0)) * std::cos(M_PI / planes);
            const auto energy = [&](double w) {
                const double x = lattice.position(Vec3d(i, 0, w)).x(), below = std::floor(x);
                const auto at = [](double voxel) { return static_cast<int>(voxel) % 3 == 0 ? 3.0 : 0.0; };
                return at(below) + (x - below) * (at(below + 1) - at(below));
            };
            double mean = 0;
            for (int n = 0; n < 200; ++n) mean += energy(k - 0.5 + (n + 0.5) / 200) / 200;
            CHECK(decode_energy(weighed[static_cast<std::size_t>(k * 7 + i)]) == Approx(volume * mean).margin(0.35 * volume));
            want += volume * mean;
            stepped += volume * energy(k);
        }
    CHECK(std::abs(got - want) < 0.3 * std::abs(stepped - want));
}

TEST_CASE("in a straight box volume and vertices measure the same, to the last bit") {
    std::mt19937 random(15);
    const auto energy = energy_grid(CoordBBox(Coord(0), Coord(20)), [&](const Coord&) { return static_cast<float>(below(random, 1000)); });
    for (const auto& lattice : {box({9, 8, 7}), make_box(Vec3d(0.3, 0.4, 1.7), {9, 8, 7}, 1.3, {2, 0, 1})})
        for (const auto axis : {Axis::u, Axis::v}) CHECK(sampled(*energy, lattice, axis, Measure::vertex) == sampled(*energy, lattice, axis, Measure::volume));
}

TEST_CASE("a ball that is attracted vanishes from a plume, and a protected one stays whole") {
    openvdb::initialize();
    openvdb::io::File file(TEST_DATA "/plume/plume.0051.vdb");
    file.open();
    const auto density = openvdb::gridPtrCast<FloatGrid>(file.readGrid("density"));
    const auto voxels = density->evalActiveVoxelBoundingBox();
    const double size = density->voxelSize().x();
    const auto first = density->indexToWorld(voxels.min());
    const auto dim = voxels.dim();
    const auto lattice = make_box(first, {dim.x(), dim.y(), dim.z()}, size, {0, 1, 2});
    const auto ball = sphere_mask(*density, density->indexToWorld(Coord(21, 21, 25)), 3.2 * size);
    REQUIRE(ball->activeVoxelCount() > 100);
    const auto carved_ball = [&](const Solved& solved) {
        const CarveMap map(lattice, {solved.seams}, 5, std::nullopt);
        return openvdb::gridConstPtrCast<MaskGrid>(carve_grid(ball, lattice, map, Interpolation::linear))->activeVoxelCount();
    };
    // Seven voxels across. The density itself is what seams avoid.
    const auto gone = solve(seam_pyramid(), "{count: -7}", {density}, {lattice}, {{"attract", {ball}}}, 1);
    CHECK(carved_ball(gone) == 0);
    CHECK(gone.listener.warnings.empty());
    std::size_t taken = 0;
    for (const auto& n : gone.listener.entry["attracted"]) taken += n.get<std::size_t>();
    CHECK(taken == ball->activeVoxelCount());
    // A window that leaves no more room beside the ball than these seams take.
    const std::string window = ", window: [11, 31]}";
    for (const auto& type : {seam_greedy(), seam_pyramid()}) {
        const auto whole = solve(type, "{count: -14" + window, {density}, {lattice}, {{"protect", {ball}}}, 1);
        CHECK(carved_ball(whole) == ball->activeVoxelCount());
        CHECK(carved_ball(solve(type, "{count: -14" + window, {density}, {lattice}, {}, 1)) < ball->activeVoxelCount());
        for (const auto& n : whole.listener.entry["protected"]) CHECK(n == 0);
        CHECK(failure_of([&] {
                  solve(type, "{count: -15" + window, {density}, {lattice}, {{"protect", {ball}}}, 1);
              }).starts_with("14 of 15 seams are possible in window [11, 31]: in frame 5 "));
    }
}
