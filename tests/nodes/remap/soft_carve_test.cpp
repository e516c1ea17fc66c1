#include "carve/remap/finish/finish.h"
#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "carve/seam/carve_inverse.h"
#include "nodes/remap.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/sampled.h"
#include "tests/support/wavy_seams.h"

#include <openvdb/tools/LevelSetSphere.h>
#include <tbb/global_control.h>
#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// `soft` and `soft_time`: the displacement of a carve smoothed.

namespace {

using Kind = Seams::Kind;

CarveMap soft_map(const Lattice& lattice, const std::vector<Seams>& sets, Softness softness,
                  int frame = 1) {
    std::vector<Ref<Seams>> list;
    for (const auto& set : sets) list.push_back(std::make_shared<Seams>(set));
    return {lattice, list, frame, {}, std::vector(list.size(), softness)};
}

/// Where a whole vertex comes from along the axis.
double source(const CarveStep& step, int entry, int lateral, int k) {
    return entry + static_cast<double>(step.soft()->entry(entry, lateral, k));
}

FloatGrid::Ptr blob(const std::array<int, 3>& shape) {
    const auto out = FloatGrid::create(0);
    auto values = out->getAccessor();
    for (auto at = CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)).begin(); at;
         ++at) {
        const auto from = (*at).asVec3d() - 0.5 * Vec3d(shape[0] - 1, shape[1] - 1, shape[2] - 1);
        values.setValueOn(*at,
                          static_cast<float>(std::exp(-from.lengthSqr() / 40) *
                                             (2 + std::sin(0.7 * (*at).x() + 0.3 * (*at).y()))));
    }
    out->setName("density");
    return out;
}

}  // namespace

TEST_CASE(
    "a softly carved map rises along its axis, and half a vertex beyond its ends it meets those of "
    "the space before") {
    std::mt19937 random(1);
    const auto axis = GENERATE(Axis::u, Axis::v, Axis::w);
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const double soft = GENERATE(0.5, 2.0, 5.0);
    const auto lattice = make_box(Vec3d(0), vertex_of(axis, 24, 7, 6), 1.0, {0, 1, 2});
    const auto seams = random_seams(random, lattice, lattice.shape, axis, kind, 7, {1, 2, 3});
    const auto map = soft_map(lattice, {seams}, {soft, 1}, 2);
    const auto& step = map.steps()[0];
    for (int k = 0; k < step.columns().slices; ++k)
        for (int lateral = 0; lateral < step.columns().laterals; ++lateral) {
            for (int e = 0; e < step.last(); ++e)
                REQUIRE(source(step, e + 1, lateral, k) > source(step, e, lateral, k) + 0.2);
            REQUIRE(source(step, 0, lateral, k) > -0.5);
            REQUIRE(source(step, step.last(), lateral, k) < step.last_before() + 0.5);
        }
}

TEST_CASE("a straight seam squeezes as a tent does, and beyond its reach whole vertices move") {
    const auto lattice = make_box(Vec3d(0), {30, 9, 9}, 1.0, {0, 1, 2});
    const auto map =
        soft_map(lattice, {straight_seams(lattice, Axis::u, Kind::remove, {15})}, {2, 0});
    const auto& step = map.steps()[0];
    // The tent 1 2 3 2 1 over a step from 0 to 1.
    const std::array expected{0.0, 1 / 9.0, 3 / 9.0, 6 / 9.0, 8 / 9.0, 1.0};
    for (int e = 0; e < 29; ++e)
        CHECK(step.soft()->entry(e, 4, 4) ==
              Approx(e < 12   ? 0
                     : e > 17 ? 1
                              : expected[static_cast<std::size_t>(e - 12)])
                  .margin(1e-6));
    CHECK(step.soft()->entry(11, 4, 4) == 0);
    CHECK(step.soft()->entry(18, 4, 4) == 1);
    // Nothing is stored where all columns move alike.
    CHECK(step.soft()->first() >= 10);
    CHECK(step.soft()->last() <= 20);
}

TEST_CASE(
    "displacements are smoothed over frames, and the sequence's ends count as often as they are "
    "near") {
    const auto lattice = make_box(Vec3d(0), {20, 1, 1}, 1.0, {0, 1, 2});
    auto seams = no_seams(lattice, Axis::u, Kind::remove, {1, 2, 3, 4});
    seams.seams.push_back({{4, 4, 10, 10}, 0.0});
    const auto at = [&](int frame) {
        return soft_map(lattice, {seams}, {0, 1}, frame).steps()[0].soft()->entry(7, 0, 0);
    };
    CHECK(at(1) == 1);
    CHECK(at(2) == Approx(0.75));
    CHECK(at(3) == Approx(0.25));
    CHECK(at(4) == 0);
}

TEST_CASE("a closed lattice is smoothed around its seam, and turning it changes nothing") {
    auto lattice = make_box(Vec3d(0), {16, 3, 12}, 1.0, {0, 1, 2});
    lattice.closed = true;
    auto seams = no_seams(lattice);
    std::vector<std::uint16_t> at, turned;
    const auto entry = [](int k) {
        return static_cast<std::uint16_t>(6 + (k % 12 < 5 ? k % 12 : k % 12 == 11 ? 1 : 2));
    };
    for (int k = 0; k < 12; ++k)
        for (int j = 0; j < 3; ++j) {
            at.push_back(entry(k));
            turned.push_back(entry(k + 5));
        }
    auto other = seams;
    seams.seams.push_back({at, 0.0});
    other.seams.push_back({turned, 0.0});
    const auto a = soft_map(lattice, {seams}, {3, 0}), b = soft_map(lattice, {other}, {3, 0});
    for (int k = 0; k < 12; ++k)
        for (int e = 0; e < 15; ++e)
            REQUIRE(a.steps()[0].soft()->entry(e, 1, (k + 5) % 12) ==
                    Approx(b.steps()[0].soft()->entry(e, 1, k)).margin(1e-6));
}

TEST_CASE(
    "pairs change nothing outside their windows, and what is between moves by whole vertices") {
    const auto lattice = make_box(Vec3d(0), {40, 5, 5}, 1.0, {0, 1, 2});
    auto seams = straight_seams(lattice, Axis::u, Kind::remove, {5, 6, 5});
    seams.pairs = straight_seams(lattice, Axis::u, Kind::insert, {26, 27, 28}).seams;
    seams.window = Window{4, 12};
    seams.pair_window = Window{24, 33};
    const auto map = soft_map(lattice, {seams}, {4, 0});
    const auto& step = map.steps()[0];
    for (int e = 0; e < 40; ++e) {
        const double d = step.soft()->entry(e, 2, 2);
        if (e < 4 || e > 33) CHECK(d == 0);
        else if (e > 9 && e < 21) CHECK(d == 3);
        else CHECK((d >= 0 && d <= 3));
    }
    const auto grid = blob({40, 5, 5});
    const auto carved =
        openvdb::gridConstPtrCast<FloatGrid>(carve_grid(grid, lattice, map, Interpolation::linear));
    for (auto at = CoordBBox(Coord(0), Coord(39, 4, 4)).begin(); at; ++at)
        if ((*at).x() < 3 || (*at).x() > 34)
            REQUIRE(carved->tree().getValue(*at) == grid->tree().getValue(*at));
}

TEST_CASE(
    "where voxels are vertices a soft carve reads between two of them, and untouched ones stay bit "
    "for bit") {
    std::mt19937 random(5);
    const auto axis = GENERATE(Axis::u, Axis::v, Axis::w);
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const auto shape = vertex_of(axis, 24, 23, 9);
    const auto lattice = make_box(Vec3d(0), shape, 1.0, {0, 1, 2});
    auto seams = wavy_seams(lattice, axis, kind, 12, 3, 1.2);
    const auto grid = blob(shape);
    const auto map = soft_map(lattice, {seams}, {2, 0});
    const auto& step = map.steps()[0];
    const auto carved =
        openvdb::gridConstPtrCast<FloatGrid>(carve_grid(grid, lattice, map, Interpolation::linear));
    auto before = grid->getConstAccessor(), after = carved->getConstAccessor();
    for (auto at = CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)).begin(); at;
         ++at) {
        const int entry = (*at)[step.axis()];
        if (entry > step.last()) {
            CHECK(after.getValue(*at) == 0);
            CHECK(!after.isValueOn(*at));
            continue;
        }
        const double from =
                         source(step, entry, (*at)[step.lateral_axis()], (*at)[step.slice_axis()]),
                     low = std::floor(from);
        auto a = *at, b = *at;
        a[step.axis()] = static_cast<int>(low);
        b[step.axis()] = static_cast<int>(low) + 1;
        if (from == entry) REQUIRE(after.getValue(*at) == before.getValue(*at));
        else
            REQUIRE(after.getValue(*at) == Approx((low + 1 - from) * before.getValue(a) +
                                                  (from - low) * before.getValue(b))
                                               .margin(1e-5));
    }
}

TEST_CASE("a soft carve is the same by whole numbers and by sampling, on one thread and on two") {
    const auto lattice = make_box(Vec3d(0), {24, 20, 18}, 1.0, {0, 1, 2});
    const auto map =
        soft_map(lattice, {wavy_seams(lattice, Axis::u, Kind::remove, 10, 4, 2)}, {3, 0});
    const auto grid = blob({24, 20, 18});
    const auto linear =
        openvdb::gridConstPtrCast<FloatGrid>(carve_grid(grid, lattice, map, Interpolation::linear));
    // The same voxels in a lattice that is no row of them.
    const auto mapping = Mapping(lattice, map.reach());
    const auto sampled = carve_sampled<FloatGrid>(grid, mapping, map, Interpolation::linear);
    for (auto at = CoordBBox(Coord(0), Coord(23, 19, 17)).begin(); at; ++at)
        REQUIRE(linear->tree().getValue(*at) == Approx(sampled->tree().getValue(*at)).margin(1e-5));
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(bytes(carve_grid(grid, lattice,
                           soft_map(lattice, {wavy_seams(lattice, Axis::u, Kind::remove, 10, 4, 2)},
                                    {3, 0}),
                           Interpolation::linear)
                    ->baseTree()) == bytes(linear->baseTree()));
}

TEST_CASE(
    "a soft carve keeps the mass of a density within 1 %, in boxes, turned ones and rings, also "
    "where seams run at an end") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const std::array shape{36, 30, 28};
    const auto grid = blob(shape);
    const auto straight = make_box(Vec3d(0), shape, 1.0, {0, 1, 2});
    const auto keeps = [&](const Lattice& lattice, const Seams& seams, double within) {
        const auto map = soft_map(lattice, {seams}, {3, 0});
        Volume volume;
        volume.grids = {grid};
        const auto out = finished(volume, carve_volume(volume, lattice, map, Interpolation::linear),
                                  lattice, map, {std::nullopt, {"density"}, false});
        CHECK(sum(*out.grids[0].grid()) == Approx(sum(*grid)).epsilon(within));
    };
    keeps(straight, wavy_seams(straight, Axis::u, kind, 17, 6, 2), 0.01);
    keeps(straight, wavy_seams(straight, Axis::u, kind, 0, 6, 0), 0.01);
    auto wide = make_box(Vec3d(-12, -12, 0), {60, 54, 28}, 1.0, {0, 1, 2});
    keeps(turned(wide, 0.12), wavy_seams(turned(wide, 0.12), Axis::u, kind, 28, 6, 2), 0.01);
}

TEST_CASE(
    "thin sheets that seams press together keep their mass, and what lies beyond the squeeze keeps "
    "its bits") {
    const auto lattice = make_box(Vec3d(0), {40, 12, 12}, 1.0, {0, 1, 2});
    const auto grid = FloatGrid::create(0);
    grid->setName("density");
    // Sheets of a few voxels, one of which eight seams press into two: between voxels it would be
    // lost or counted twice.
    const std::array profile{0.5f, 2.0f, 3.0f, 2.0f, 0.5f};
    for (int j = 0; j < 12; ++j)
        for (int k = 0; k < 12; ++k)
            for (const int first : {2, 13, 20, 33})
                for (int n = 0; n < 5; ++n)
                    grid->tree().setValue({first + n, j, k}, profile[static_cast<std::size_t>(n)]);
    const auto map = soft_map(
        lattice, {straight_seams(lattice, Axis::u, Kind::remove, {15, 15, 15, 15, 15, 15, 15, 15})},
        {2, 0});
    Volume volume;
    volume.grids = {grid};
    const auto carved = carve_volume(volume, lattice, map, Interpolation::linear);
    const auto out = finished(volume, carved, lattice, map, {std::nullopt, {"density"}, false});
    CHECK(std::abs(sum(*carved.grids[0].grid()) / sum(*grid) - 1) > 0.05);
    CHECK(sum(*out.grids[0].grid()) == Approx(sum(*grid)).epsilon(0.01));
    const auto kept = openvdb::gridConstPtrCast<FloatGrid>(out.grids[0]);
    CHECK(kept->tree().getValue({4, 5, 5}) == 3);
    CHECK(kept->tree().getValue({27, 5, 5}) == 3);
    CHECK_FALSE(kept->tree().isValueOn({20, 5, 5}));
}

TEST_CASE(
    "a softness wider than the lattice is refused, but not the one that a small lattice gets by "
    "itself") {
    const auto carve = [](int size, const std::string& yaml) {
        const auto lattice = make_box(Vec3d(0), {size, 4, 4}, 1.0, {0, 1, 2});
        const auto seams =
            std::make_shared<Seams>(straight_seams(lattice, Axis::u, Kind::remove, {1}));
        const auto volume = std::make_shared<Volume>();
        volume->grids = {blob({size, 4, 4})};
        NodeBench(remap_grids(), yaml)
            .run({{"source", {Payload(volume)}},
                  {"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
                  {"seams", {Payload(seams)}}});
    };
    CHECK(failure_of([&] { carve(8, "{soft: 9}"); }) ==
          "soft 9 is wider than the lattice, which has 8 vertices along u; lower it");
    carve(8, "{soft: 8}");
    carve(2, "{soft: 3}");
}

TEST_CASE(
    "points go by the inverse of a soft map, are thinned and doubled to their density, and stay "
    "where nothing moves") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const auto lattice = make_box(Vec3d(0), {40, 30, 30}, 1.0, {0, 1, 2});
    std::vector<Vec3d> positions;
    std::vector<std::uint64_t> ids;
    for (int n = 0; n < 300000; ++n) {
        positions.push_back(Vec3d(unit(random), unit(random), unit(random)) * Vec3d(39, 29, 29));
        ids.push_back(static_cast<std::uint64_t>(n));
    }
    const auto map = soft_map(lattice,
                              {straight_seams(lattice, Axis::u, kind,
                                              kind == Kind::remove ? std::vector{18, 18, 18, 18}
                                                                   : std::vector{17, 18, 19, 20})},
                              {3, 0});
    const auto carved = carve_points(positions, ids, lattice, map, default_jitter);
    std::vector<double> slices(60, 0.0);
    for (const auto& image : carved.images)
        ++slices[static_cast<std::size_t>(
            (image.moved ? image.position : positions[image.source]).x())];
    const double density = 300000.0 / 39;
    // Three standard deviations of such a number.
    for (std::size_t n = 1; n + 1 < (kind == Kind::remove ? 34 : 42); ++n)
        CHECK(slices[n] == Approx(density).epsilon(0.02 + 3 / std::sqrt(density)));
    CHECK(static_cast<double>(carved.images.size()) ==
          Approx(density * (kind == Kind::remove ? 35 : 43)).epsilon(0.005));
    for (const auto& image : carved.images)
        if (positions[image.source].x() < 10) REQUIRE(!image.moved);
    // By the point alone: half of the points fare the same without the others.
    const std::vector<Vec3d> half(positions.begin(), positions.begin() + 150000);
    const auto alone = carve_points(half, ids, lattice, map, default_jitter);
    for (std::size_t n = 0; n < alone.images.size(); ++n)
        REQUIRE(alone.images[n].source == carved.images[n].source);
}

TEST_CASE("a soft map and its inverse lead back to the same place, in chains too") {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto lattice = make_box(Vec3d(0), {24, 20, 12}, 1.0, {0, 1, 2});
    auto inner = lattice;
    inner.shape[0] -= 4;
    const auto map = soft_map(lattice,
                              {wavy_seams(lattice, Axis::u, Kind::remove, 9, 4, 1),
                               wavy_seams(inner, Axis::v, Kind::insert, 8, 3, 1)},
                              {2, 0});
    for (int n = 0; n < 500; ++n) {
        const Vec3d at(2 + 15 * unit(random), 2 + 15 * unit(random), 11 * unit(random));
        auto back = at;
        for (auto step = map.steps().rbegin(); step != map.steps().rend(); ++step)
            back[step->axis()] += step->soft()->at(back, *step).d;
        CHECK((carved_coordinates(map, back) - at).length() < 1e-4);
    }
}
