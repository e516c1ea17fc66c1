#include "carve/solver/costs/prices.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "nodes/seam.h"
#include "tests/support/brute_force.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <random>
#include <set>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

// `spread`: what a seam takes is handed on. And `empty`, which prices what shows nothing.

namespace {

EnergyVolume column_of(const std::vector<float>& energies) {
    EnergyVolume out({{static_cast<int>(energies.size()), 1, 1}, Axis::u, 1});
    for (std::size_t n = 0; n < energies.size(); ++n) out.codes(0)[n] = encode_energy(energies[n]);
    return out;
}

std::vector<float> values_of(const EnergyVolume& energy) {
    std::vector<float> out;
    for (int n = 0; n < energy.width(); ++n)
        out.push_back(decode_energy(energy.codes(0)[static_cast<std::size_t>(n)]));
    return out;
}

FloatGrid::Ptr noise_grid(std::mt19937& random, const std::array<int, 3>& shape) {
    return energy_grid(CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)),
                       [&](const Coord&) { return static_cast<float>(1 + random() % 256) / 64; });
}

}  // namespace

TEST_CASE(
    "a taken entry's energy goes in equal shares to those within `spread`, and only to the "
    "window") {
    auto energy = column_of({8, 1, 4, 2, 16, 32});
    energy.set_spread(2, false);
    const std::vector<std::uint16_t> at{2};
    SECTION("to both sides") {
        energy.remove(at, {0, 5});
        CHECK(values_of(energy) == std::vector<float>{9, 2, 3, 17, 32});
    }
    SECTION("not out of the window") {
        energy.remove(at, {1, 3});
        CHECK(values_of(energy) == std::vector<float>{8, 3, 4, 16, 32});
    }
    SECTION("not to protected and attracted vertices") {
        energy.codes(0)[1] = protected_code;
        energy.codes(0)[3] = attracted_code;
        energy.remove(at, {0, 5});
        CHECK(energy.codes(0)[1] == protected_code);
        CHECK(energy.codes(0)[2] == attracted_code);
        CHECK(decode_energy(energy.codes(0)[0]) == 10);
        CHECK(decode_energy(energy.codes(0)[3]) == 18);
    }
    SECTION("and nowhere without a spread") {
        energy.set_spread(0, false);
        energy.remove(at, {0, 5});
        CHECK(values_of(energy) == std::vector<float>{8, 1, 2, 16, 32});
    }
}

TEST_CASE("a still seam hands on in the sum") {
    EnergyVolume energy({{4, 1, 1}, Axis::u, 2});
    for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t n = 0; n < 4; ++n)
            energy.codes(t)[n] = encode_energy(static_cast<float>(n + 1));
    energy.set_spread(1, false);
    auto sum = energy.sum();
    sum.remove(std::vector<std::uint16_t>{1}, {0, 3});
    CHECK(std::vector<float>(sum.cells<float>(0), sum.cells<float>(0) + 3) ==
          std::vector<float>{4, 8, 8});
}

TEST_CASE("with forward costs the energy is handed on and edges are counted anew") {
    const auto make = [](const std::vector<float>& energies) {
        auto out = column_of(energies);
        add_field(out, 1, [](auto, std::size_t n) { return n * n; });
        return out;
    };
    auto energy = make({1, 2, 4, 8, 16, 32});
    energy.count_edges({});
    energy.set_spread(1, false);
    energy.remove(std::vector<std::uint16_t>{2}, {0, 5});
    // The field is 0 1 9 16 25 now.
    CHECK(values_of(energy) == std::vector<float>{1 + 1, 4 + 9, 10 + 15, 16 + 16, 32 + 9});
}

TEST_CASE("seams that hand on what they take do not bunch") {
    const auto valley = energy_grid(CoordBBox(Coord(0), Coord(23, 3, 3)), [](const Coord& at) {
        return at.x() == 11 || at.x() == 12 ? 0.5f : 1.0f;
    });
    for (const auto& solver : {seam_pyramid(), seam_greedy()})
        for (const auto* const count : {"-8", "8"}) {
            const auto columns = [&](const std::string& spread) {
                const auto solved =
                    solve(solver, std::string("{count: ") + count + ", spread: " + spread + "}",
                          {valley}, {box({24, 4, 4})}, {}, 1);
                std::set<int> out;
                std::vector<std::uint16_t> entries, sorted;
                for (const auto& seam : solved.seams->seams) entries.push_back(seam.at[0]);
                if (solved.seams->kind == Seams::Kind::remove) to_original(entries, sorted);
                out.insert(entries.begin(), entries.end());
                return std::pair(*out.begin(), *out.rbegin());
            };
            const auto [first, last] = columns("3");
            CHECK(last - first >= 12);
        }
}

TEST_CASE("with a spread, too, many seams at once are the same as few, then more") {
    std::mt19937 random(2);
    const auto energy = noise_grid(random, {14, 6, 5});
    for (const std::string more :
         {", spread: 2}", ", spread: 3, window: [2, 11]}", ", spread: 2, static: true}",
          ", spread: 1, window: [1, 5], pair_window: [8, 12]}"})
        for (const std::string sign : {"-", ""}) {
            const auto find = [&](const std::string& count, const Otherwise& otherwise = {}) {
                return solve(seam_pyramid(), "{count: " + sign + count + more,
                             {energy, noise_grid(random, {14, 6, 5})}, {box({14, 6, 5})}, {}, 2, {},
                             otherwise);
            };
            random.seed(9);
            const auto all = find("4");
            random.seed(9);
            const auto some = find("2");
            random.seed(9);
            Otherwise go_on;
            go_on.before = some.seams;
            go_on.reported = some.listener.entry;
            const auto resumed = find("4", go_on);
            REQUIRE(all.seams->seams.size() == 4);
            for (std::size_t n = 0; n < 4; ++n) {
                INFO(more << ", seam " << n);
                REQUIRE(all.seams->seams[n].at == resumed.seams->seams[n].at);
                REQUIRE(all.seams->seams[n].energy == resumed.seams->seams[n].energy);
                if (n < 2) REQUIRE(all.seams->seams[n].at == some.seams->seams[n].at);
            }
        }
}

TEST_CASE(
    "a field says where content is: empty space has its price, whatever the units and the "
    "resolution") {
    // A layer of content in the middle third.
    const auto make = [](float energy_unit, float field_unit) {
        const CoordBBox all(Coord(0), Coord(29, 3, 3));
        const auto inside = [](const Coord& at) { return at.x() >= 10 && at.x() < 20; };
        return std::pair(
            energy_grid(all, [=](const Coord& at) { return inside(at) ? energy_unit : 0.0f; }),
            energy_grid(all, [=](const Coord& at) {
                return inside(at) ? field_unit * (1 + 0.1f * static_cast<float>(at.x() % 3)) : 0.0f;
            }));
    };
    const auto in_content = [&](float energy_unit, float field_unit, const std::string& empty) {
        const auto [energy, field] = make(energy_unit, field_unit);
        const auto solved = solve(seam_pyramid(), "{count: -9, spread: 3, empty: " + empty + "}",
                                  {energy}, {box({30, 4, 4})}, {{"field", {field}}}, 1);
        std::vector<std::uint16_t> entries, sorted;
        for (const auto& seam : solved.seams->seams) entries.push_back(seam.at[0]);
        to_original(entries, sorted);
        return std::ranges::count_if(sorted, [](int entry) { return entry >= 10 && entry < 20; });
    };
    CHECK(in_content(1, 1, "0.01") == 0);
    CHECK(in_content(1, 1, "10") >= 7);
    for (const auto* const empty : {"0.5", "1", "2"})
        CHECK(in_content(1, 1, empty) == in_content(256, 1 / 64.0f, empty));
    CHECK(in_content(1, 1, "2") >= in_content(1, 1, "0.5"));
}

TEST_CASE("a field that is the same everywhere is refused") {
    const CoordBBox all(Coord(0), Coord(5, 3, 3));
    const auto flat = energy_grid(all, [](const Coord&) { return 0.25f; });
    CHECK_THROWS_WITH(
        solve(seam_pyramid(), "{count: -1}", {flat}, {box({6, 4, 4})}, {{"field", {flat}}}, 1),
        "`field` is 0.25 at all vertices of the lattice in all frames: it shows no content and no "
        "edges; connect the grid that people see, such "
        "as the density, or leave `field` out");
}
