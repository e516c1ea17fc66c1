#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "carve/remap/joining.h"
#include "carve/remap/voxels/band_blend.h"
#include "carve/seam/joins.h"
#include "nodes/remap.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/seams_through.h"

#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// `join`: how both sides of thick seams meet.

namespace {

using Kind = Seams::Kind;
constexpr std::array<int, 3> joined_shape{60, 9, 10};
const CoordBBox joined_voxels(Coord(0),
                              Coord(joined_shape[0] - 1, joined_shape[1] - 1, joined_shape[2] - 1));

Lattice joined_box() { return make_box(Vec3d(0), joined_shape, 1.0, {0, 1, 2}); }

/// Slabs of one thickness.
/// @param begins  first entry of each, in the space before it if it is removed, else original
Seams slab_set(const Lattice& lattice, Kind kind, int thickness, const std::vector<int>& begins) {
    std::vector<int> entries;
    for (const int begin : begins)
        for (int n = 0; n < thickness; ++n)
            entries.push_back(begin + (kind == Kind::insert ? n : 0));
    auto out = straight_seams(lattice, Axis::u, kind, entries);
    out.thickness = thickness;
    return out;
}

CarveMap joined_map(const Lattice& lattice, const Seams& seams, const JoinParams& params = {}) {
    return {
        lattice, {std::make_shared<Seams>(seams)}, 1, {}, std::vector{softness_of(params, seams)}};
}

FloatGrid::Ptr joined_grid(const std::function<float(const Coord& at)>& value) {
    const auto out = FloatGrid::create(0);
    auto values = out->getAccessor();
    for (auto at = joined_voxels.begin(); at; ++at)
        if (const float v = value(*at); v != 0) values.setValueOn(*at, v);
    out->setName("density");
    return out;
}

}  // namespace

TEST_CASE("a slab is cut out whole, and doubled as a block") {
    const auto lattice = joined_box();
    const auto grid = joined_grid([](const Coord& at) { return static_cast<float>(at.x() + 1); });
    const JoinParams cut{Join::cut, {}, {}, 0};
    const auto row = [&](const Seams& seams) {
        const auto out = carved<FloatGrid>(grid, lattice, joined_map(lattice, seams, cut));
        std::vector<float> values;
        for (int x = 0; x < joined_shape[0] + 8; ++x)
            values.push_back(out->tree().getValue(Coord(x, 4, 5)));
        return values;
    };
    const auto less = row(slab_set(lattice, Kind::remove, 4, {20, 30})),
               more = row(slab_set(lattice, Kind::insert, 4, {20, 40}));
    for (int x = 0; x < 52; ++x)
        CHECK(less[static_cast<std::size_t>(x)] ==
              static_cast<float>(x + 1 + (x >= 20 ? 4 : 0) + (x >= 30 ? 4 : 0)));
    CHECK(less[52] == 0);
    for (int x = 0; x < 68; ++x)
        CHECK(more[static_cast<std::size_t>(x)] ==
              static_cast<float>(x + 1 - (x >= 24 ? 4 : 0) - (x >= 48 ? 4 : 0)));
}

TEST_CASE(
    "the sides of joins have weights that sum to one, also where joins overlap, and far away there "
    "is one") {
    const auto lattice = joined_box();
    for (const auto kind : {Kind::remove, Kind::insert})
        for (const int apart : {2, 5, 15}) {
            const auto map = joined_map(lattice, slab_set(lattice, kind, 6, {20, 20 + apart}));
            const auto& step = map.steps().front();
            std::vector<Joins::Side> sides;
            for (double u = 0; u < step.after() - 1; u += 0.37) {
                step.joins()->sides(Vec3d(u, 3.2, 4.7), sides);
                const double sum =
                    std::accumulate(sides.begin(), sides.end(), 0.0,
                                    [](double all, const auto& side) { return all + side.weight; });
                REQUIRE(sum == Approx(1));
                for (const auto& side : sides) {
                    REQUIRE(side.weight > 0);
                    REQUIRE(side.by == std::round(side.by));
                }
                if (u < 14) REQUIRE((sides.size() == 1 && sides.front().by == 0));
            }
            step.joins()->sides(Vec3d(step.after() - 1, 3, 4), sides);
            REQUIRE((sides.size() == 1 && sides.front().by == (kind == Kind::remove ? 12 : -12)));
        }
}

TEST_CASE(
    "what a join does not reach moves by whole vertices, bit for bit, what is even stays even, and "
    "what is empty stays empty") {
    const auto lattice = joined_box();
    for (const auto kind : {Kind::remove, Kind::insert}) {
        const auto set = slab_set(lattice, kind, 6, {27});
        const auto map = joined_map(lattice, set);
        const int moves = kind == Kind::remove ? 6 : -6;
        SECTION(kind == Kind::remove ? "removed" : "doubled") {
            const auto detail = joined_grid([](const Coord& at) {
                return 2 + std::sin(1.1f * static_cast<float>(at.x()) + static_cast<float>(at.y()));
            });
            const auto out = carved<FloatGrid>(detail, lattice, map);
            for (auto at = joined_voxels.begin(); at; ++at) {
                const int x = (*at).x();
                if (x < 27 - 12) REQUIRE(out->tree().getValue(*at) == detail->tree().getValue(*at));
                if (x > 33 + 12 && x - std::min(moves, 0) < joined_shape[0] &&
                    x + moves < joined_shape[0])
                    REQUIRE(out->tree().getValue(*at) ==
                            detail->tree().getValue((*at).offsetBy(moves, 0, 0)));
                REQUIRE(std::isfinite(out->tree().getValue(*at)));
            }
            const auto even =
                carved<FloatGrid>(joined_grid([](const Coord&) { return 0.7f; }), lattice, map);
            for (int x = 10; x < 45; ++x)
                CHECK(even->tree().getValue(Coord(x, 4, 5)) == Approx(0.7f).epsilon(0.002));
            // A wall that ends at y = 4: no halo beyond.
            const auto wall = carved<FloatGrid>(
                joined_grid([](const Coord& at) { return at.y() <= 4 ? 1.0f : 0.0f; }), lattice,
                map);
            for (int x = 0; x < joined_shape[0]; ++x)
                for (int y = 5; y < joined_shape[1]; ++y) {
                    REQUIRE(wall->tree().getValue(Coord(x, y, 5)) == 0);
                    REQUIRE(!wall->tree().isValueOn(Coord(x, y, 5)));
                }
        }
    }
}

TEST_CASE("detail keeps its shape on both sides of a join where the two match") {
    const auto lattice = joined_box();
    // Waves of six voxels: sides six voxels apart match everywhere, so that nothing shows where the
    // join is.
    const auto wave = [](int x) {
        return 1 + 0.5f * std::sin(static_cast<float>(2 * M_PI / 6 * x));
    };
    for (const auto kind : {Kind::remove, Kind::insert}) {
        const auto error = [&](const JoinParams& params) {
            const auto out = carved<FloatGrid>(
                joined_grid([&](const Coord& at) { return wave(at.x()); }), lattice,
                joined_map(lattice, slab_set(lattice, kind, 6, {27}), params));
            double sum = 0;
            for (int x = 10; x < 48; ++x)
                sum += std::abs(out->tree().getValue(Coord(x, 4, 5)) - wave(x));
            return sum / 38;
        };
        CHECK(error({}) < 0.05);
        CHECK(error({Join::squeeze, {}, {}, 0}) > 3 * error({}));
    }
}

TEST_CASE("an outline in a doubled slab is stretched, not shown twice") {
    const auto lattice = joined_box();
    const auto set = slab_set(lattice, Kind::insert, 6, {34});
    const auto wall = joined_grid([](const Coord& at) { return at.x() < 37 ? 1.0f : 0.0f; });
    const auto out = carved<FloatGrid>(wall, lattice, joined_map(lattice, set));
    int edges = 0;
    for (int x = 1; x < joined_shape[0]; ++x) {
        const float before = out->tree().getValue(Coord(x - 1, 4, 5)),
                    here = out->tree().getValue(Coord(x, 4, 5));
        CHECK(here <= before + 1e-4f);
        edges += before >= 0.5f && here < 0.5f;
    }
    CHECK(edges == 1);
}

TEST_CASE(
    "a side fits while its slow part has most of what it should be, and more of it where nothing "
    "is shown") {
    const auto of = [](double slow, double wanted, double value) {
        return misfit(Shown{{slow}, {value}}, Shown{{wanted}, {1}});
    };
    CHECK(of(1, 1, 0) == 0);
    CHECK(of(0, 0, 0) == 0);
    CHECK(of(0.71, 1, 1) == 0);
    CHECK(of(1, 0.5, 1) == Approx(0.5));
    CHECK(of(0.5, 1, 1) == Approx(0.5));
    CHECK(of(1, 0.3, 1) == 1);
    CHECK(of(1, 0, 1) == 1);
    CHECK(of(1, -1, 1) == 1);
    CHECK(of(1, 0.75, 0.05) == Approx(0.5));
    CHECK(of(1, 0.6, 0) == 1);
    CHECK(misfit({0, 0.5, 0}, {0, 0.6, 0.8}, 0.7, 0.3) == Approx(0.5));
}

TEST_CASE("two bands: detail that is faded keeps its strength, and what is empty stays empty") {
    TwoBands<float> bands{1.2f, 0.9f, {1}, {1}};
    bands.highest = 2;
    bands.squares = 1;
    CHECK(bands.value() == Approx(1.2f));
    // Half of each of two sides: a mean of details is flatter by the root of their squared weights'
    // mean with one.
    bands.squares = 0.5;
    CHECK(bands.value() == Approx(1 + 0.2 / std::sqrt(0.75)));
    bands.wanted = {0.5};
    CHECK(bands.value() == Approx(0.5 * (1 + 0.2 / std::sqrt(0.75))));
    bands.stretch = 1;
    CHECK(bands.value() == Approx(0.9f));
    CHECK((TwoBands<float>{0, 0, {0.5}, {1}, 0, 1, 2}).value() == 0);
    CHECK((TwoBands<float>{1, 0, {0.5}, {0}, 0, 1, 2}).value() == 0);
}

TEST_CASE("whole numbers are never blended, and level sets only faded") {
    const auto lattice = joined_box();
    const auto map = joined_map(lattice, slab_set(lattice, Kind::remove, 6, {27}));
    const auto ids = openvdb::Int32Grid::create(0);
    for (auto at = joined_voxels.begin(); at; ++at) ids->tree().setValueOn(*at, 100 * (*at).x());
    const auto out = carved<openvdb::Int32Grid>(ids, lattice, map);
    for (int x = 0; x < 54; ++x)
        CHECK(out->tree().getValue(Coord(x, 4, 5)) == 100 * (x < 27 ? x : x + 6));

    const auto sphere =
        openvdb::tools::createLevelSetSphere<FloatGrid>(3.0f, openvdb::Vec3f(12, 4, 5), 1.0f, 3.0f);
    const auto faded = carved<FloatGrid>(sphere, lattice, map);
    CHECK(faded->tree().getValue(Coord(12, 4, 5)) == sphere->tree().getValue(Coord(12, 4, 5)));
}

TEST_CASE("a staggered velocity that is the same everywhere stays so") {
    const auto lattice = joined_box();
    const auto grid = VectorGrid::create(openvdb::Vec3f(0));
    for (auto at = joined_voxels.begin(); at; ++at)
        grid->tree().setValueOn(*at, openvdb::Vec3f(1, 2, 3));
    grid->setGridClass(openvdb::GRID_STAGGERED);
    for (const auto kind : {Kind::remove, Kind::insert}) {
        const auto out = carved<VectorGrid>(grid, lattice,
                                            joined_map(lattice, slab_set(lattice, kind, 6, {27})));
        for (int x = 12; x < 45; ++x) {
            const auto got = out->tree().getValue(Coord(x, 4, 5));
            CHECK(got.eq(openvdb::Vec3f(1, 2, 3), 0.01f));
        }
    }
}

TEST_CASE("around a ring joins close, and what is even stays even") {
    const auto lattice = ring(Vec3d(0), {25, 7, 60}, 1.0, openvdb::Vec2d(-8, -3));
    const auto grid = FloatGrid::create(0);
    for (int x = -30; x <= 30; ++x)
        for (int y = -30; y <= 30; ++y)
            for (int z = -8; z <= 8; ++z) grid->tree().setValueOn(Coord(x, y, z), 1.0f);
    auto set = slab_set(lattice, Kind::remove, 4, {9});
    set.closed = lattice.closed;
    const auto out = carved<FloatGrid>(grid, lattice, joined_map(lattice, set));
    for (const auto& at : {Coord(9, 0, 0), Coord(0, 9, 0), Coord(-7, 7, 0), Coord(8, -4, 1)})
        CHECK(out->tree().getValue(at) == Approx(1).epsilon(0.01));
}

TEST_CASE(
    "points on both sides of a join are thinned by their weights, by their identity alone, and "
    "keep their density") {
    const auto lattice = joined_box();
    std::vector<Vec3d> positions;
    std::vector<std::uint64_t> identities;
    std::uint64_t seed = 1;
    const auto next = [&] {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(seed >> 11) * 0x1p-53;
    };
    for (int n = 0; n < 60'000; ++n) {
        positions.emplace_back(59 * next(), 8 * next(), 9 * next());
        identities.push_back(static_cast<std::uint64_t>(n));
    }
    for (const auto kind : {Kind::remove, Kind::insert}) {
        const auto map = joined_map(lattice, slab_set(lattice, kind, 6, {14, 33}));
        const auto out = carve_points(positions, identities, lattice, map, 0);
        const int size = kind == Kind::remove ? 48 : 72;
        std::vector<int> counts(static_cast<std::size_t>(size) / 6 + 1);
        for (const auto& image : out.images) {
            const auto at = image.moved ? image.position.x() : positions[image.source].x();
            ++counts[static_cast<std::size_t>(std::clamp(at / 6, 0.0, size / 6.0))];
        }
        for (int n = 0; n < (size - 1) / 6; ++n)
            CHECK(counts[static_cast<std::size_t>(n)] == Approx(60'000 * 6.0 / 59).epsilon(0.04));
        // The same in any order.
        auto turned = positions;
        auto names = identities;
        std::ranges::reverse(turned);
        std::ranges::reverse(names);
        const auto back = carve_points(turned, names, lattice, map, 0);
        CHECK(back.images.size() == out.images.size());
        CHECK(back.deleted == out.deleted);
    }
}

TEST_CASE("joins that do not go together or do not fit are refused, with what to do") {
    const auto faults = [](const std::string& yaml) {
        return NodeBench(remap_grids(), yaml).faults();
    };
    CHECK(
        faults("{join: squeeze, fade: 4}") ==
        "fade: nothing is blended unless `join` is fade; set `join: fade`, or leave `fade` out\n");
    CHECK(faults("{join: fade, soft: 4}") ==
          "soft: `soft` is the reach of `join: squeeze`; set that, or leave `soft` out\n");
    CHECK(faults("{join: fade, fade: 4}") == "");
    CHECK(
        faults("{fade: 4, soft: 2}") ==
        "soft: `soft` is for `join: squeeze`, `fade` for `join: fade`: leave one of the two out\n");
    const auto lattice = joined_box();
    const auto set = slab_set(lattice, Kind::remove, 6, {10, 20, 30});
    CHECK(failure_of([&] {
              softness_of({Join::fade, 25.0, {}, 0}, set);
          }) ==
          "fade 25 is wider than what lies between two joins: 3 slabs in 60 vertices along u leave "
          "20 to each; lower it, or ask for less");
    CHECK(softness_of({}, set).fade > 0);
    CHECK(softness_of({{}, {}, 0.0, 0}, set).fade == 0);
    CHECK_FALSE(softness_of({Join::cut, {}, {}, 0}, set));
}
