#include "carve/lattice/mapping.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/sample.h"
#include "carve/solver/pyramid.h"
#include "carve/volume/volume.h"
#include "nodes/seam.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/reference_carve.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// `measure: volume`: energies by the space around a vertex.

namespace {

std::vector<std::uint16_t> sampled(const FloatGrid& grid, const Lattice& lattice, Axis axis,
                                   Measure measure) {
    std::vector<std::uint16_t> out(static_cast<std::size_t>(lattice.shape[0]) *
                                   static_cast<std::size_t>(lattice.shape[1]) *
                                   static_cast<std::size_t>(lattice.shape[2]));
    sample_energy(grid, lattice, axis, out, measure);
    return out;
}

}  // namespace

TEST_CASE("by volume, a ring's vertices weigh as much as their distance from the axis") {
    const int planes = 90;
    const auto lattice = ring(Vec3d(30, 30, 10), {13, 4, planes}, 1.0, openvdb::Vec2d(-6, -2));
    const auto flat =
        energy_grid(CoordBBox(Coord(0), Coord(60, 60, 20)), [](const Coord&) { return 2.0f; });
    const double radius = ring_radius(planes, 1.0);
    for (const auto axis : {Axis::u, Axis::v, Axis::w}) {
        const auto plain = sampled(*flat, lattice, axis, Measure::vertex),
                   weighed = sampled(*flat, lattice, axis, Measure::volume);
        for (int k = 0; k < planes; ++k)
            for (int j = 0; j < 4; ++j)
                for (int i = 0; i < 13; ++i) {
                    const auto place =
                        static_cast<std::size_t>(axis == Axis::u   ? (k * 4 + j) * 13 + i
                                                 : axis == Axis::v ? (k * 13 + i) * 4 + j
                                                                   : (j * 13 + i) * planes + k);
                    REQUIRE(decode_energy(plain[place]) == 2);
                    // Codes round to 5e-4; a ring of planes is a polygon, 6e-4 smaller.
                    REQUIRE(decode_energy(weighed[place]) ==
                            Approx(2 * (1 + (i - 6) / radius)).epsilon(1.2e-3));
                }
    }
    // A seam along v, and its energy, are by volume too: it costs as much as the space that it
    // takes.
    const auto solved =
        solve(seam_pyramid(), "{count: -1, axis: v, measure: volume}", {flat}, {lattice}, {}, 1);
    CHECK(solved.listener.entry["energy"][0].get<double>() ==
          Approx(2.0 * 13 * planes).epsilon(1.2e-3));
    const auto vertices = solve(seam_pyramid(), "{count: -1, axis: v}", {flat}, {lattice}, {}, 1);
    CHECK(vertices.listener.entry["energy"][0].get<double>() ==
          Approx(2.0 * 13 * planes).epsilon(1e-6));
    // The innermost seam across u is the shortest way around.
    const auto inner =
        solve(seam_pyramid(), "{count: -1, measure: volume}", {flat}, {lattice}, {}, 1);
    CHECK(std::ranges::all_of(inner.seams->seams[0].at, [](int entry) { return entry == 0; }));
    CHECK(inner.listener.entry["energy"][0].get<double>() ==
          Approx(2 * (1 - 6 / radius) * 4 * planes).epsilon(1.2e-3));
}

TEST_CASE("by volume, what is further apart than a spacing is averaged, not stepped over") {
    // A narrow ring: outside its planes are more than three spacings apart. Thin sheets through the
    // axis are dear.
    const int planes = 12;
    const auto lattice = ring(Vec3d(15, 15, 5), {7, 1, planes}, 1.0, openvdb::Vec2d(0, 0));
    const auto stripes = energy_grid(CoordBBox(Coord(0), Coord(30, 30, 10)),
                                     [](const Coord& at) { return at.x() % 3 == 0 ? 3.0f : 0.0f; });
    const auto weighed = sampled(*stripes, lattice, Axis::u, Measure::volume);
    double got = 0, stepped = 0, want = 0;
    for (int k = 0; k < planes; ++k)
        for (int i = 4; i < 7; ++i) {
            got += decode_energy(weighed[static_cast<std::size_t>(k * 7 + i)]);
            // The integral over each cell's arc, finely.
            const double volume = (1 + i / ring_radius(planes, 1.0)) * std::cos(M_PI / planes);
            const auto energy = [&](double w) {
                const double x = lattice.position(Vec3d(i, 0, w)).x(), below = std::floor(x);
                const auto at = [](double voxel) {
                    return static_cast<int>(voxel) % 3 == 0 ? 3.0 : 0.0;
                };
                return at(below) + (x - below) * (at(below + 1) - at(below));
            };
            double mean = 0;
            for (int n = 0; n < 200; ++n) mean += energy(k - 0.5 + (n + 0.5) / 200) / 200;
            CHECK(decode_energy(weighed[static_cast<std::size_t>(k * 7 + i)]) ==
                  Approx(volume * mean).margin(0.35 * volume));
            want += volume * mean;
            stepped += volume * energy(k);
        }
    CHECK(std::abs(got - want) < 0.3 * std::abs(stepped - want));
}

TEST_CASE("in a straight box volume and vertices measure the same, to the last bit") {
    std::mt19937 random(15);
    const auto energy = energy_grid(CoordBBox(Coord(0), Coord(20)), [&](const Coord&) {
        return static_cast<float>(below(random, 1000));
    });
    for (const auto& lattice :
         {box({9, 8, 7}), make_box(Vec3d(0.3, 0.4, 1.7), {9, 8, 7}, 1.3, {2, 0, 1})})
        for (const auto axis : {Axis::u, Axis::v, Axis::w})
            CHECK(sampled(*energy, lattice, axis, Measure::vertex) ==
                  sampled(*energy, lattice, axis, Measure::volume));
}
