#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "carve/seam/carve_inverse.h"
#include "carve/solver/pyramid.h"
#include "formats/seam_file/seam_file.h"
#include "nodes/seam.h"
#include "tests/support/reference_carve.h"
#include "tests/support/solver_bench.h"
#include "tests/support/wavy_seams.h"

#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// `anchor`: what stays where it is.

namespace {

using Kind = Seams::Kind;

constexpr std::array shape{14, 9, 8};
const Lattice lattice = make_box(Vec3d(0), shape, 1.0, {0, 1, 2});

FloatGrid::Ptr noisy_box() {
    std::mt19937 random(1);
    return energy_grid(CoordBBox(Coord(0), Coord(13, 8, 7)),
                       [&](const Coord&) { return static_cast<float>(1 + random() % 1000); });
}

Seams anchored(Seams seams, Anchor anchor) {
    seams.anchor = anchor;
    seams.find_shifts();
    return seams;
}

FloatGrid::ConstPtr carved_by_sets(const FloatGrid::Ptr& grid, const Lattice& in,
                                   const std::vector<Seams>& sets, Softness softness = {}) {
    std::vector<Ref<Seams>> list;
    for (const auto& set : sets) list.push_back(std::make_shared<Seams>(set));
    return openvdb::gridConstPtrCast<FloatGrid>(
        carve_grid(grid, in, CarveMap(in, list, 1, {}, std::vector(list.size(), softness)),
                   Interpolation::linear));
}

constexpr Anchor middle{Anchor::At::middle, 0}, high{Anchor::At::high, 0};

}  // namespace

TEST_CASE(
    "an anchor shifts the whole result by whole voxels, softly carved or not, and what it frees is "
    "empty") {
    std::mt19937 random(2);
    const auto axis = GENERATE(Axis::u, Axis::v, Axis::w);
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const double soft = GENERATE(0.0, 2.0);
    const auto grid = noisy_box();
    const auto seams = random_seams(random, lattice, shape, axis, kind, 4, {1});
    const auto base = carved_by_sets(grid, lattice, {seams}, {soft, 0});
    for (const auto& [anchor, by] : {std::pair(middle, 2), std::pair(high, 4)}) {
        const int shift = kind == Kind::remove ? by : -by;
        const auto moved = carved_by_sets(grid, lattice, {anchored(seams, anchor)}, {soft, 0});
        for (auto at = CoordBBox(Coord(-6), Coord(22)).begin(); at; ++at) {
            auto from = *at;
            from[static_cast<int>(axis)] -= shift;
            bool beside = false;
            for (const auto n : {lateral_dimension(axis), slice_dimension(axis)})
                beside = beside || (*at)[static_cast<int>(n)] < 0 ||
                         (*at)[static_cast<int>(n)] >= shape[n];
            INFO("shift " << shift << " at " << *at);
            REQUIRE(moved->tree().isValueOn(*at) ==
                    (beside ? false : base->tree().isValueOn(from)));
            REQUIRE(moved->tree().getValue(*at) ==
                    Approx(beside ? 0 : base->tree().getValue(from)).margin(soft > 0 ? 1e-3 : 0));
        }
    }
}

TEST_CASE(
    "the content of an anchored vertex stays: as many vertices go below it as the result is "
    "shifted by") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    // Two of three seams run below vertex 9.
    const auto seams =
        straight_seams(lattice, Axis::u, kind,
                       kind == Kind::remove ? std::vector{3, 4, 10} : std::vector{3, 5, 11});
    const auto grid = noisy_box();
    const auto out = carved_by_sets(grid, lattice, {anchored(seams, {Anchor::At::vertex, 9})});
    for (int y = 0; y < 9; ++y)
        for (int z = 0; z < 8; ++z)
            CHECK(out->tree().getValue(Coord(9, y, z)) == grid->tree().getValue(Coord(9, y, z)));
    CHECK(anchored(seams, {Anchor::At::vertex, 9}).shifts ==
          (kind == Kind::remove ? std::vector{0, 1, 2, 2} : std::vector{0, -1, -2, -2}));
}

TEST_CASE("anchored carves chain, along one axis and along all") {
    std::mt19937 random(3);
    const auto grid = noisy_box();
    const auto first = random_seams(random, lattice, shape, Axis::u, Kind::insert, 3, {1});
    auto grown = shape;
    grown[0] += 3;
    const auto second = random_seams(random, lattice, grown, Axis::u, Kind::remove, 5, {1});
    auto shrunk = grown;
    shrunk[0] -= 5;
    const auto third = random_seams(random, lattice, shrunk, Axis::v, Kind::remove, 2, {1});
    auto flat = shrunk;
    flat[1] -= 2;
    const auto fourth = random_seams(random, lattice, flat, Axis::w, Kind::insert, 3, {1});
    auto tall = flat;
    tall[2] += 3;
    const auto fifth = random_seams(random, lattice, tall, Axis::u, Kind::remove, 2, {1});
    const auto base = carved_by_sets(grid, lattice, {first, second, third, fourth, fifth});
    const auto out = carved_by_sets(grid, lattice,
                                    {anchored(first, high), anchored(second, middle),
                                     anchored(third, high), anchored(fourth, high), fifth});
    // -3, then +2 along u; +2 along v; -3 along w.
    for (auto at = CoordBBox(Coord(0), Coord(9, 6, 10)).begin(); at; ++at)
        REQUIRE(out->tree().getValue((*at).offsetBy(-1, 2, -3)) == base->tree().getValue(*at));
}

TEST_CASE("points and bent lattices follow an anchor") {
    auto bent = lattice;
    bent.closed = false;
    for (std::size_t k = 0; k < bent.planes.size(); ++k) {
        const double angle = 0.05 * static_cast<double>(k);
        auto& plane = bent.planes[k];
        plane.u = Vec3d(std::cos(angle), 0, std::sin(angle));
        plane.w = Vec3d(-std::sin(angle), 0, std::cos(angle));
        plane.origin = 20 * plane.u;
    }
    bent.hash = lattice_hash(bent);
    for (const auto kind : {Kind::remove, Kind::insert}) {
        auto seams = straight_seams(bent, Axis::u, kind,
                                    kind == Kind::remove ? std::vector{5, 5} : std::vector{5, 6});
        const auto at = bent.position(Vec3d(11, 4, 3)), below = bent.position(Vec3d(2, 4, 3));
        const auto go = [&](const Vec3d& from) {
            const CarveMap map(bent, {std::make_shared<Seams>(seams)}, 1, {});
            const auto points = carve_points({from}, {1}, bent, map, 0);
            REQUIRE(points.images.size() == 1);
            return points.images[0].moved ? points.images[0].position : from;
        };
        const int by = kind == Kind::remove ? 2 : -2;
        CHECK((go(at) - bent.position(Vec3d(11 - by, 4, 3))).length() < 1e-6);
        seams = anchored(seams, high);
        CHECK((go(at) - at).length() < 1e-9);
        CHECK((go(below) - bent.position(Vec3d(2 + by, 4, 3))).length() < 1e-6);
    }
}

TEST_CASE("an anchor and windows stay with seams that are kept in a file") {
    auto seams =
        anchored(straight_seams(lattice, Axis::u, Kind::remove, {4, 4}), {Anchor::At::vertex, 9});
    seams.window = Window{2, 8};
    const auto back = seams_from_volume(seams_to_volume(seams));
    CHECK(back.anchor == seams.anchor);
    CHECK(back.shifts == seams.shifts);
    CHECK((back.window && back.window->first == 2 && back.window->last == 8));
    auto volume = seams_to_volume(seams);
    volume.metadata.removeMeta("fluidcarve_anchor");
    volume.metadata.insertMeta("fluidcarve_anchor", openvdb::StringMetadata("14"));
    CHECK(failure_of([&] { seams_from_volume(volume); })
              .find("'fluidcarve_anchor' must be low, middle, high or a vertex from 0 to 13, not "
                    "'14'") != std::string::npos);
}

TEST_CASE("solvers take an anchor, and refuse one beyond the lattice, below it or beside pairs") {
    const auto energy = noisy_box();
    CHECK(solve(seam_pyramid(), "{count: -2, anchor: middle}", {energy}, {lattice}, {}, 1)
              .seams->shift_after(2) == 1);
    CHECK(solve(seam_pyramid(), "{count: 2, anchor: high}", {energy}, {lattice}, {}, 1)
              .seams->shift_after(2) == -2);
    CHECK_THROWS_WITH(solve(seam_pyramid(), "{count: -2, anchor: 14}", {energy}, {lattice}, {}, 1),
                      "anchor 14 lies beyond the lattice, which has 14 vertices along u: 0 to 13");
    CHECK(NodeBench(seam_pyramid(), "{count: -1, anchor: -2}").faults() ==
          "anchor: parameter 'anchor' must be low, middle, high or a vertex from 0 on, not -2\n");
    CHECK(
        NodeBench(seam_pyramid(), "{count: -1, anchor: high, window: [0, 3], pair_window: [5, 7]}")
            .faults() ==
        "anchor: pairs of seams move neither end of the lattice: leave 'anchor' out\n");
}
