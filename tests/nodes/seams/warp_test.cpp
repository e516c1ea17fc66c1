#include "carve/seam/warp.h"
#include "carve/seam/carve_inverse.h"
#include "carve/seam/carve_map.h"
#include "carve/solver/costs/carve.h"
#include "carve/solver/costs/code.h"
#include "nodes/params/carve_inputs.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"
#include "tests/support/solver_bench.h"
#include "tests/support/warped.h"
#include "tests/support/wavy_seams.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

std::vector<float> column(const Warp& warp, int lateral, int k, std::size_t t = 0) {
    std::vector<float> out(static_cast<std::size_t>(warp.vertices()[0]));
    warp.column(t, lateral, k, out);
    return out;
}

/// Squeezes by three vertices around the middle, more in the middle columns, in each frame
/// otherwise.
double bump(int entry, int lateral, int k, int t) {
    return -(3.0 + 0.1 * lateral - 0.05 * k + 0.2 * t) /
           (1 + std::exp(-(entry - 14.0 - 0.3 * lateral) / 1.5)) * (entry == 0 ? 0 : 1);
}

/// Where a carved place comes from, by the step's displacements.
double source(const CarveStep& step, const Vec3d& at) {
    const int j = std::min(static_cast<int>(at[step.lateral_axis()]),
                           step.columns().last_lateral()),
              k = static_cast<int>(at[step.slice_axis()]);
    const int e = std::min(static_cast<int>(at[step.axis()]), step.last());
    const auto d = [&](int de, int dj, int dk) {
        return static_cast<double>(step.soft()->entry(
            e + de, std::min(j + dj, step.columns().last_lateral()),
            step.columns().closed ? (k + dk) % step.columns().slices
                                  : std::min(k + dk, step.columns().slices - 1)));
    };
    const double x = at[step.axis()] - e, y = at[step.lateral_axis()] - j,
                 z = at[step.slice_axis()] - k;
    double out = at[step.axis()];
    for (int n = 0; n < 8; ++n)
        out += (n & 1 ? x : 1 - x) * (n & 2 ? y : 1 - y) * (n & 4 ? z : 1 - z) *
               d(n & 1, n >> 1 & 1, n >> 2 & 1);
    return out;
}

}  // namespace

TEST_CASE(
    "between its points a warp is trilinear, up to the last vertices and across the closing of "
    "rings") {
    const int factor = GENERATE(1, 2, 4);
    const bool closed = GENERATE(false, true);
    auto lattice = box({19, 10, 11});
    lattice.closed = closed;
    const auto plane = [&](int entry, int lateral, int k, int) {
        return 0.25 * entry - 0.5 * lateral + (closed ? 0 : 0.125 * k) + 1;
    };
    const auto seams = warped(lattice, plane, Axis::u, {1}, factor);
    for (int k = 0; k < 11; ++k)
        for (int lateral = 0; lateral < 10; ++lateral) {
            const auto found = column(*seams.warp, lateral, k);
            for (int u = 0; u < 19; ++u)
                REQUIRE(found[static_cast<std::size_t>(u)] ==
                        Approx(plane(u, lateral, k, 0)).margin(1e-5));
        }
    if (!closed || factor == 1) return;
    // Behind the last point along w the displacement goes back to that of the first.
    const auto rising = warped(
        lattice, [](int, int, int k, int) { return k; }, Axis::u, {1}, factor);
    const int last = rising.warp->vertex_of(2, rising.warp->points()[2] - 1);
    for (int k = last; k < 11; ++k)
        CHECK(column(*rising.warp, 3, k)[5] == Approx(last * (11.0 - k) / (11 - last)));
    // Around a rig, behind the last point along v.
    lattice.around = true;
    const auto turning = warped(
        lattice, [](int, int lateral, int, int) { return lateral; }, Axis::u, {1}, factor);
    const int end = turning.warp->vertex_of(1, turning.warp->points()[1] - 1);
    for (int lateral = end; lateral < 10; ++lateral)
        CHECK(column(*turning.warp, lateral, 3)[5] == Approx(end * (10.0 - lateral) / (10 - end)));
}

TEST_CASE("a warp is linear in its scale, and copies of it share their values") {
    const auto lattice = box({12, 4, 3});
    auto seams = warped(lattice, bump);
    auto twice = *seams.warp;
    twice.set_scale(2);
    CHECK(twice.values(0).data() == std::as_const(*seams.warp).values(0).data());
    for (std::size_t u = 0; u < 12; ++u)
        CHECK(column(twice, 1, 2)[u] == 2 * column(*seams.warp, 1, 2)[u]);
    CHECK(twice.scaled(twice.bounds().last).least == 2 * seams.warp->bounds().last.least);
    twice.set_scale(-1);
    CHECK(twice.scaled(twice.bounds().value).most == -seams.warp->bounds().value.least);
}

TEST_CASE("an anchor holds a place of each column, and leaves columns alone that do not move") {
    const auto lattice = box({21, 4, 3});
    const auto ramp = [](int entry, int lateral, int, int) { return -0.1 * entry * lateral; };
    for (const auto& [anchor, at] :
         {std::pair(Anchor{Anchor::At::low, 0}, 0), std::pair(Anchor{Anchor::At::middle, 0}, 10),
          std::pair(Anchor{Anchor::At::high, 0}, 20),
          std::pair(Anchor{Anchor::At::vertex, 7}, 7)}) {
        const int factor = GENERATE(1, 4);
        auto warp = *warped(lattice, ramp, Axis::u, {1}, factor).warp;
        warp.anchor_at(anchor);
        for (int lateral = 0; lateral < 4; ++lateral) {
            const auto found = column(warp, lateral, 1);
            for (int u = 0; u < 21; ++u)
                CHECK(found[static_cast<std::size_t>(u)] ==
                      Approx(-0.1 * (u - at) * lateral).margin(1e-5));
            if (lateral == 0)
                CHECK(std::ranges::all_of(found, [](float value) { return value == 0; }));
        }
    }
}

TEST_CASE("a warp leaves as many whole vertices as hold its content in all columns and frames") {
    const auto lattice = box({30, 4, 3});
    const auto shape_of = [&](const Shift& shift) {
        return warped(lattice, shift, Axis::u, {1, 2}).shape_after(1)[0];
    };
    CHECK(shape_of(evenly(lattice, -7.25)) == 23);
    CHECK(shape_of(evenly(lattice, -7)) == 23);
    CHECK(shape_of(evenly(lattice, 7.25)) == 38);
    // Columns and frames that keep their width keep the space.
    CHECK(shape_of([](int entry, int lateral, int, int) {
              return lateral == 2 ? 0 : -entry / 5.0;
          }) == 30);
    CHECK(shape_of([](int entry, int, int, int t) { return t == 1 ? 0 : -entry / 5.0; }) == 30);
    // Content of either end may leave the space before.
    const auto both =
        warped(lattice, [](int entry, int, int, int) { return (entry - 14.5) * 0.1; });
    CHECK(both.shift_after(1) == -2);
    CHECK(both.shape_after(1)[0] == 34);
    CHECK(both.shape_after(0)[0] == 30);
    CHECK(both.shift_after(0) == 0);
}

TEST_CASE(
    "the map of a warp undoes it: even scaling is even, and each vertex comes from where it went") {
    const auto axis = GENERATE(Axis::u, Axis::v, Axis::w);
    const auto lattice = box(vertex_of(axis, 40, 6, 5));
    for (const double by : {-1.5, -7.25, 12.0, -20.0}) {
        const auto map = map_of(lattice, {warped(lattice, evenly(lattice, by, axis), axis)});
        const auto& step = map.steps().at(0);
        for (int e = 0; e <= std::floor(39 + by); ++e)
            REQUIRE(e + static_cast<double>(step.soft()->entry(e, 3, 2)) ==
                    Approx(e * 39 / (39 + by)).margin(1e-3));
    }
    const auto map = map_of(lattice, {warped(lattice, bump, axis)});
    const auto& step = map.steps().at(0);
    for (int n = 0; n < 400; ++n) {
        Vec3d from(0.0);
        from[step.slice_axis()] = n % 9 / 2.0;
        from[step.axis()] = n % 79 / 2.0;
        from[step.lateral_axis()] = n % 11 / 2.0;
        const auto to = carved_coordinates(map, from);
        REQUIRE(source(step, to) == Approx(from[step.axis()]).margin(1e-4));
    }
}

TEST_CASE("where a warp is 0 its map and its inverse are the identity, bit for bit") {
    const auto lattice = box({30, 6, 5});
    // Only lateral 3 and higher move, only from vertex 10 to 19, and the frame of t = 1 not at all.
    const auto part = [](int entry, int lateral, int, int t) {
        return t == 1 || lateral < 3 || entry < 10 || entry > 19
                   ? 0
                   : -std::sin(M_PI * (entry - 10) / 9.0);
    };
    const auto seams = warped(lattice, part, Axis::u, {1, 2});
    CHECK(seams.shape_after(1) == lattice.shape);
    const auto map = map_of(lattice, {seams});
    const auto& step = map.steps().at(0);
    CHECK((step.first_moved() >= 10 && step.last_moved() <= 19));
    for (int e = 0; e < 30; ++e)
        for (int lateral = 0; lateral < 6; ++lateral) {
            if (e >= 10 && e <= 19 && lateral > 2) continue;
            CHECK(step.soft()->entry(e, lateral, 2) == 0);
            const Vec3d at(e, lateral, 2);
            CHECK(carved_coordinates(map, at) == at);
        }
    CHECK(carved_coordinates(map, {15.3, 1.7, 2.2}) == Vec3d(15.3, 1.7, 2.2));
    openvdb::BBoxd range(Vec3d(21, 0, 0), Vec3d(29, 5, 4));
    bool frees = false;
    CHECK(!map.trace(range, frees));
    const auto still = map_of(lattice, {seams}, 2);
    CHECK(carved_coordinates(still, {14.5, 4.2, 3.1}) == Vec3d(14.5, 4.2, 3.1));
}

TEST_CASE("a warp's map has no step where a ring closes") {
    const auto lattice = ring(Vec3d(0), {20, 6, 24}, 0.5, {1, 0});
    const auto wave = [](int entry, int, int k, int) {
        return -0.2 * entry * (1 + 0.5 * std::sin(2 * M_PI * k / 24));
    };
    const auto map = map_of(lattice, {warped(lattice, wave, Axis::u, {1}, 2)});
    double most = 0;
    for (double w = 0; w < 24; w += 0.25) {
        const auto at = [&](double place) {
            return carved_coordinates(map, {12.5, 2, place < 24 ? place : place - 24}).x();
        };
        most = std::max(most, std::abs(at(w + 0.25) - at(w)));
    }
    CHECK(most < 0.1);
    CHECK(most > 0.05);
}

TEST_CASE("seams and warps chain in their order") {
    const auto lattice = box({30, 5, 4});
    const auto seams = straight_seams(lattice, Axis::u, Seams::Kind::remove, {20, 20});
    auto after = lattice;
    after.shape[0] = 28;
    auto warp = warped(after, evenly(after, -13.5));
    warp.lattice_hash = lattice.hash;
    const auto chain =
        CarveMap(lattice, {std::make_shared<Seams>(seams), std::make_shared<Seams>(warp)}, 1, {},
                 std::vector(2, Softness{2, 0}));
    CHECK(chain.soft());
    CHECK(chain.steps().back().after() == 15);
    CHECK(carved_coordinates(chain, {10, 2, 2}).x() == Approx(5).margin(1e-4));
    CHECK(carved_coordinates(chain, {27, 2, 2}).x() == Approx(12.5).margin(1e-4));
    // The other way round the seams carve what the warp leaves.
    auto later = straight_seams(lattice, Axis::u, Seams::Kind::remove, {10, 10});
    const auto first = warped(lattice, evenly(lattice, -14.5));
    later.shape = first.shape_after(1);
    const auto other =
        CarveMap(lattice, {std::make_shared<Seams>(first), std::make_shared<Seams>(later)}, 1, {},
                 std::vector(2, Softness{0, 0}));
    CHECK(carved_coordinates(other, {10, 2, 2}).x() == Approx(5).margin(1e-4));
    CHECK(carved_coordinates(other, {28, 2, 2}).x() == Approx(12).margin(1e-4));
    CHECK(failure_of([&] {
              map_of(lattice, {first, seams});
          }) ==
          "seam set 2 of 2 carves 30 x 5 x 4 vertices, but set 1 leaves 16 x 5 x 4; list the sets "
          "in the order in which they were found");
}

TEST_CASE(
    "a warp is carved whole or, with a count of 0, not at all, and softness leaves it as it is") {
    const auto lattice = box({20, 4, 3});
    const std::vector<Ref<Seams>> sets{
        std::make_shared<Seams>(warped(lattice, evenly(lattice, -4)))};
    CHECK(carve_map(lattice, sets, Count{0}, 1).empty());
    CHECK(failure_of([&] { carve_map(lattice, sets, Count{-2}, 1); }) ==
          "the last input of `seams` is a warp, which has no seams to count and is carved as a "
          "whole; leave `count` out, or set the warp's `amount`");
    const auto plain = carve_map(lattice, sets, {}, 1),
               soft = carve_map(lattice, sets, {}, 1, {Join::squeeze, {}, 3, 1});
    for (int e = 0; e <= plain.steps()[0].last(); ++e)
        CHECK(plain.steps()[0].soft()->entry(e, 1, 1) == soft.steps()[0].soft()->entry(e, 1, 1));
}

TEST_CASE(
    "an energy is carried into the space that a warp leaves, with its marks, and is nothing where "
    "no content is") {
    const auto lattice = box({9, 2, 1});
    // Column 0 becomes half as wide; column 1 stays.
    const auto map = map_of(lattice, {warped(lattice, [](int entry, int lateral, int, int) {
                                return lateral == 0 ? -0.5 * entry : 0;
                            })});
    std::vector<std::uint16_t> codes;
    for (int n = 0; n < 18; ++n)
        codes.push_back(n % 9 == 5 ? protected_code : encode_energy(static_cast<float>(n % 9)));
    const auto carved = carve_energy(codes, lattice.shape, Axis::u, map.steps(), 1);
    REQUIRE(carved.size() == 18);
    for (std::size_t e = 0; e < 9; ++e) {
        CHECK(carved[9 + e] == codes[9 + e]);
        CHECK(decode_energy(carved[e]) == Approx(e <= 4 ? 2.0 * static_cast<double>(e) : 0.0));
    }
    // Between a vertex that is protected and one that is not, a vertex is protected.
    const auto third = map_of(lattice, {warped(lattice, evenly(lattice, -2))});
    const auto thinner = carve_energy(codes, lattice.shape, Axis::u, third.steps(), 1);
    REQUIRE(thinner.size() == 14);
    CHECK(thinner[3] == encode_energy(4));
    CHECK(thinner[4] == protected_code);
}

TEST_CASE("a warp beyond the budget is held in a file, and is the same") {
    const Scratch scratch;
    const std::array vertices{7, 5, 3};
    Warp in_file(vertices, {}, 1, 4, {100, scratch / "work"}), in_memory(vertices, {}, 1, 4);
    for (auto* const warp : {&in_file, &in_memory}) {
        for (std::size_t t = 0; t < 4; ++t)
            for (std::size_t n = 0; n < warp->values(t).size(); ++n)
                warp->values(t)[n] =
                    static_cast<float>(0.01 * static_cast<double>(n) + static_cast<double>(t));
        warp->anchor_at({Anchor::At::high, 0});
        warp->find_bounds();
    }
    for (std::size_t t = 0; t < 4; ++t)
        CHECK(std::ranges::equal(in_file.values(t), in_memory.values(t)));
    CHECK(in_file.bounds().value.least == in_memory.bounds().value.least);
    CHECK(in_file.bounds().last.most == 0);
}
