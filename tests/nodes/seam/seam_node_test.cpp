#include "nodes/solving/seam_node.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/greedy.h"
#include "carve/volume/volume.h"
#include "nodes/params/param_forms.h"
#include "nodes/seam.h"
#include "tests/support/reference_carve.h"
#include "tests/support/searches.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// What all solvers have in common, through seam.greedy: pairs, static seams, seams after others.

namespace {

const std::vector<int> frames{5, 6, 7};

Solved solve(const std::string& yaml, const std::vector<FloatGrid::Ptr>& energy,
             const Lattice& lattice, const std::vector<Ref<Seams>>& after = {}) {
    return fluidcarve::test::solve(seam_greedy(), yaml, energy, {lattice}, {}, frames.size(),
                                   after);
}

/// Whole numbers, so that means are exact in 16 bits.
std::vector<FloatGrid::Ptr> noise(std::mt19937& random, const std::array<int, 3>& shape,
                                  std::size_t count = frames.size()) {
    std::vector<FloatGrid::Ptr> out;
    for (std::size_t t = 0; t < count; ++t) {
        out.push_back(FloatGrid::create());
        auto values = out.back()->getAccessor();
        for (auto at = CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)).begin();
             at; ++at)
            values.setValueOn(*at, float(random() % 64));
    }
    return out;
}

EnergyVolume volume_of(const std::vector<FloatGrid::Ptr>& energy, const std::array<int, 3>& shape) {
    EnergyVolume out({shape, Axis::u, energy.size()});
    for (std::size_t t = 0; t < energy.size(); ++t)
        for (std::size_t n = 0; n < out.codes(t).size(); ++n) {
            const auto width = static_cast<std::size_t>(shape[0]),
                       laterals = static_cast<std::size_t>(shape[1]);
            out.codes(t)[n] = encode_energy(energy[t]->tree().getValue(
                Coord(int(n % width), int(n / width % laterals), int(n / width / laterals))));
        }
    return out;
}

void check_same(const std::vector<Seams::Seam>& got, const std::vector<Seams::Seam>& want) {
    REQUIRE(got.size() == want.size());
    for (std::size_t n = 0; n < got.size(); ++n) {
        CHECK(got[n].at == want[n].at);
        CHECK(got[n].energy == want[n].energy);
    }
}

std::string faults(const std::string& yaml) { return NodeBench(seam_greedy(), yaml).faults(); }

}  // namespace

TEST_CASE(
    "seams come in pairs of opposite kinds, each window solved as if the other were not there") {
    std::mt19937 random(1);
    const std::array<int, 3> shape{16, 5, 4};
    const auto energy = noise(random, shape);
    for (const int count : {-3, 3}) {
        const auto kind = count < 0 ? Seams::Kind::remove : Seams::Kind::insert;
        const auto solved =
            solve(fmt::format("{{count: {}, window: [1, 6], pair_window: [7, 15]}}", count), energy,
                  box(shape));
        auto first = volume_of(energy, shape), second = volume_of(energy, shape);
        check_same(solved.seams->seams,
                   find_seams(first, {kind, {1, 6}}, 3, greedy(16), nobody).seams);
        check_same(solved.seams->pairs,
                   find_seams(second, {opposite(kind), {7, 15}}, 3, greedy(16), nobody).seams);
        CHECK(solved.seams->kind == kind);
        CHECK(solved.seams->shape_after(3) == shape);
        CHECK(solved.listener.entry["energy"][2] == solved.seams->seams[2].energy);
        CHECK(solved.listener.entry["pair_energy"].size() == 3);
        CHECK(solved.listener.entry["pair_energy"][1] == solved.seams->pairs[1].energy);
        CHECK(solved.listener.entry["shape"] == nlohmann::ordered_json({16, 5, 4, 3}));
    }
    CHECK(!solve("{count: -3, window: [1, 6]}", energy, box(shape))
               .listener.entry.contains("pair_energy"));
}

TEST_CASE("either window may be static: a river bank beside a river") {
    std::mt19937 random(2);
    const std::array<int, 3> shape{16, 5, 4};
    const auto energy = noise(random, shape);
    const auto moves = [](const Seams::Seam& seam) {
        return !std::equal(seam.at.begin(), seam.at.begin() + 40, seam.at.begin() + 20);
    };
    const auto free =
        solve("{count: -2, window: [1, 6], pair_window: [8, 14]}", energy, box(shape));
    const auto bank = solve("{count: -2, window: [1, 6], pair_window: [8, 14], pair_static: true}",
                            energy, box(shape));
    const auto both =
        solve("{count: 2, window: [1, 6], pair_window: [8, 14], static: true, pair_static: true}",
              energy, box(shape));
    for (std::size_t n = 0; n < 2; ++n) {
        CHECK(moves(free.seams->pairs[n]));
        CHECK(moves(bank.seams->seams[n]));
        CHECK(!moves(bank.seams->pairs[n]));
        CHECK(!moves(both.seams->seams[n]));
        CHECK(!moves(both.seams->pairs[n]));
    }
    check_same(bank.seams->seams, free.seams->seams);
    double sum = 0;
    const auto& at = bank.seams->pairs[0].at;
    for (std::size_t c = 0; c < at.size(); ++c)
        sum += energy[c / 20]->tree().getValue(Coord(at[c], int(c % 5), int(c % 20 / 5)));
    CHECK(bank.listener.entry["pair_energy"][0] == sum);
}

TEST_CASE("a window in shares holds for any spacing, and is checked once the lattice is known") {
    const auto parsed = [](const std::string& window) {
        return NodeBench(seam_greedy(), "{count: -1, window: " + window + "}").faults();
    };
    CHECK(parsed("[0%, 50%]").empty());
    CHECK(parsed("[0%, 150%]") == "window must be from 0% to 100%, not 150%\n");
    CHECK(parsed("[60%, 50%]") == "window has its first vertex 60% above its last one 50%\n");
    CHECK(parsed("[0, 50%]") ==
          "window must be [first, last], whole vertices or shares of them such as [0%, 50%], not "
          "[0, 50%]\n");
    const VertexRange half{0, 50, true};
    CHECK(half.of(33).last == 16);
    CHECK(half.of(10).last == 5);
    CHECK(VertexRange{56, 100, true}.of(33).first == 18);
    CHECK(VertexRange{2, 14}.of(33).first == 2);
    CHECK(!half.vertices());
    CHECK(VertexRange{2, 14}.vertices()->last == 14);
    CHECK(ParamTraits<VertexRange>::text(half) == "[0%, 50%]");
}

TEST_CASE("windows that do not go together are told before anything runs") {
    CHECK(
        faults("{count: 1, pair_window: [3, 4]}") ==
        "pair_window: parameter 'pair_window' needs a 'window' beside it, below it on the axis\n");
    CHECK(faults("{count: 1, window: [2, 5], pair_window: [5, 7]}") ==
          "pair_window: pair_window [5, 7] overlaps window [2, 5]; it must begin above vertex 5\n");
    CHECK(
        faults("{count: 1, window: [4, 5], pair_window: [0, 2]}") ==
        "pair_window: pair_window [0, 2] lies below window [4, 5]; it must begin above vertex 5\n");
    CHECK(faults("{count: 1, window: [4, 5], pair_window: [6.5, 8]}") ==
          "pair_window must be [first, last], whole vertices or shares of them such as [0%, 50%], "
          "not [6.5, 8]\n");
    CHECK(faults("{count: 1, window: [4, 5], pair_static: true}") ==
          "pair_static: parameter 'pair_static' needs a 'pair_window'\n");
    CHECK(faults("{count: 1, window: [4, 5], pair_window: [6, 8]}") == "");

    std::mt19937 random(3);
    const auto energy = noise(random, {8, 3, 3});
    const auto failure = [&](const std::string& yaml) {
        return failure_of([&] { solve(yaml, energy, box({8, 3, 3})); });
    };
    CHECK(failure("{count: 1, window: [0, 3], pair_window: [4, 8]}") ==
          "pair_window [4, 8] leaves the lattice, which has 8 vertices along u: 0 to 7");
    CHECK(failure("{count: 3, window: [0, 3], pair_window: [4, 5]}") ==
          "3 seams do not fit: window [4, 5] has room to remove 2");
    CHECK(failure("{count: -3, window: [0, 3], pair_window: [5, 7]}") ==
          "3 seams do not fit: window [5, 7] has room to insert 2; a new vertex goes between two "
          "old ones, so none can follow the lattice's last vertex");
    CHECK(failure("{count: -1, guide: gaussian}") ==
          "guide 'gaussian' leads seams through a closed lattice back to where they began, but "
          "this lattice is open; leave `guide` out");
}

TEST_CASE("seams after others are those of the energy that the others leave") {
    std::mt19937 random(4);
    const auto mean = [](const auto& a, const auto& b) {
        return Dense<float>::Voxel{0.5f * (a.value + b.value), true};
    };
    const Layout layout;
    for (int n = 0; n < 30; ++n) {
        const auto lattice =
            box({8 + below(random, 6), 8 + below(random, 6), 6 + below(random, 4)});
        const bool once = n % 4 == 0;  // one energy for all frames
        auto energy = noise(random, lattice.shape, once ? 1 : frames.size());
        const auto after = random_sets(random, lattice, 1 + n % 3, 2, frames);
        const auto shape = after.back()->shape_after(after.back()->seams.size());
        const std::string yaml =
            std::array{"{count: -2, axis: u, window: [1, 4]}", "{count: 3, axis: v}",
                       "{count: -1, axis: w}"}[static_cast<std::size_t>(n / 4 % 3)];
        const auto got = solve(yaml, energy, lattice, after);

        std::vector<FloatGrid::Ptr> carved;
        for (std::size_t t = 0; t < frames.size(); ++t) {
            Dense<float> dense(*energy[once ? 0 : t], CoordBBox(Coord(0), Coord(23, 23, 23)));
            for (const auto& set : after)
                carve(dense, layout, *set, t, set->seams.size(), 0.0f, mean);
            carved.push_back(FloatGrid::create());
            for (auto at =
                     CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)).begin();
                 at; ++at)
                carved.back()->tree().setValueOn(*at, dense.at(*at).value);
        }
        const auto want = solve(yaml, carved, box(shape));
        INFO("case " << n);
        check_same(got.seams->seams, want.seams->seams);
        CHECK(got.seams->shape == shape);
        CHECK(got.seams->lattice_hash == lattice.hash);
        // They chain: remap takes them in this order.
        auto chain = after;
        chain.push_back(got.seams);
        CHECK_NOTHROW(CarveMap(lattice, chain, 6, {}));
    }
}

TEST_CASE("seams after others count the vertices that those leave") {
    std::mt19937 random(5);
    const auto lattice = box({10, 4, 4});
    const auto energy = noise(random, lattice.shape);
    const auto six = std::make_shared<Seams>(
        random_seams(random, lattice, lattice.shape, Axis::u, Seams::Kind::remove, 6, frames));
    const auto failure = [&](const std::string& yaml, const std::vector<Ref<Seams>>& after) {
        return failure_of([&] { solve(yaml, energy, lattice, after); });
    };
    CHECK(solve("{count: -50%}", energy, lattice, {six}).seams->seams.size() == 2);
    CHECK(solve("{count: 0}", energy, lattice, {six}).seams->shape == std::array{4, 4, 4});
    CHECK(failure("{count: -1, window: [2, 5]}", {six}) ==
          "window [2, 5] leaves the lattice, which has 4 vertices along u once the seams of "
          "`after` are carved: 0 to 3");
    CHECK(failure("{count: -5}", {six}) ==
          "count -5 removes more than the 4 vertices along u once the seams of `after` are carved; "
          "at most 3 can go");
    CHECK(failure("{count: -1}", {six, six}) ==
          "seam set 2 of 2 carves 10 x 4 x 4 vertices, but set 1 leaves 4 x 4 x 4; list the sets "
          "in the order in which they were found");
    auto all = *six;
    all.seams.resize(10, all.seams[0]);
    CHECK(failure("{count: -1, axis: v}", {std::make_shared<Seams>(all)})
              .find("the seams of `after` leave nothing to carve: 0 x 4 x 4 vertices") == 0);
}

TEST_CASE("seams of a lattice that moves remember each frame's lattice") {
    std::mt19937 random(6);
    const auto energy = noise(random, {8, 4, 4});
    std::vector<Lattice> lattices{
        box({8, 4, 4}), make_box(Vec3d(0, 1, 0), {8, 4, 4}, 1.0, {0, 1, 2}), box({8, 4, 4})};
    Listener listener;
    NodeBench bench(seam_greedy(), "{count: -1}");
    for (std::size_t t = 0; t < 3; ++t)
        bench.add({{"energy", {Payload(energy[t])}},
                   {"lattice", {Payload(std::make_shared<Lattice>(lattices[t]))}}},
                  Context(listener, frames).at(t));
    // At the end a lattice that comes per frame is not there any more.
    const auto seams = bench.gathered({}, Context(listener, frames)).at("seams").as<Seams>();
    CHECK(seams->lattice_hash ==
          lattices[0].hash + "," + lattices[1].hash + "," + lattices[2].hash);
    for (std::size_t t = 0; t < 3; ++t) {
        CHECK(seams->lattice_hash_at(t) == lattices[t].hash);
        CHECK_NOTHROW(CarveMap(lattices[t], {seams}, frames[t], {}));
    }
    CHECK(failure_of([&] {
              CarveMap(lattices[0], {seams}, 6, {});
          }).find("the seams were found in another lattice") == 0);

    NodeBench other(seam_greedy(), "{count: -1}");
    const auto add = [&](const Lattice& lattice, std::size_t t) {
        other.add({{"energy", {Payload(energy[t])}},
                   {"lattice", {Payload(std::make_shared<Lattice>(lattice))}}},
                  Context(listener, frames).at(t));
    };
    add(lattices[0], 0);
    CHECK(failure_of([&] {
              add(box({8, 4, 3}), 1);
          }) == "the lattice has 8 x 4 x 3 vertices here, but 8 x 4 x 4 in the first frame");
}
