#include "carve/remap/finish/finish.h"
#include "carve/remap/finish/tears.h"
#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "carve/remap/voxels/seam_cells.h"
#include "carve/seam/carve_inverse.h"
#include "carve/seam/step_columns.h"
#include "carve/solver/greedy.h"
#include "nodes/seam.h"
#include "nodes/warp.h"
#include "tests/support/built_lattices.h"
#include "tests/support/sampled.h"
#include "tests/support/solver_bench.h"
#include "tests/support/warped.h"
#include "tests/support/wavy_seams.h"

#include <openvdb/tools/Interpolation.h>
#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// Carves in a lattice around its rig.

namespace {

using Kind = Seams::Kind;

Lattice helix_lattice() { return around(through(helix_points()), 0.9, 0.1); }
Lattice ring_lattice() { return around(through(saddle_points(), true), 0.8, 0.1); }

CarveMap soft_map_of(const Lattice& lattice, const Seams& seams, double soft) {
    return {lattice, {std::make_shared<Seams>(seams)}, 1, {}, std::vector{Softness{soft, 0}}};
}

/// Seams that wander across v and close there, from vertex 1 on; removals as each is found in what
/// those before leave.
Seams wandering(const Lattice& lattice, Kind kind, int count, int lowest) {
    auto out = no_seams(lattice, Axis::u, kind);
    for (int n = 0; n < count; ++n) {
        std::vector<std::uint16_t> at;
        for (int k = 0; k < out.shape[2]; ++k)
            for (int j = 0; j < out.shape[1]; ++j) {
                const double wave = 1 + std::sin(2 * M_PI *
                                                 (2 * j / static_cast<double>(out.shape[1]) +
                                                  3 * k / static_cast<double>(out.shape[2])));
                at.push_back(static_cast<std::uint16_t>(lowest + (kind == Kind::insert ? n : 0) +
                                                        static_cast<int>(std::lround(wave))));
            }
        out.seams.push_back({at, 0.0});
    }
    return out;
}

FloatGrid::Ptr field_in(const Lattice& lattice, double voxel,
                        const std::function<float(const Vec3d&)>& value) {
    const auto box = Mapping(lattice).world_box(
        BBoxd(Vec3d(0), Vec3d(lattice.shape[0] + 4, lattice.shape[1], lattice.shape[2])));
    const auto out = sampled<FloatGrid>(CoordBBox(Coord::floor(box.min() / voxel).offsetBy(-3),
                                                  Coord::ceil(box.max() / voxel).offsetBy(3)),
                                        voxel, value);
    out->setName("density");
    return out;
}

/// A warp of a lattice around its rig, which differs from column to column and closes: by so much
/// at the end, by up to half more elsewhere.
Shift uneven(const Lattice& lattice, double by) {
    return [by, &lattice](int entry, int lateral, int k, int) {
        const double turn = 2 * M_PI *
                            (2 * lateral / static_cast<double>(lattice.shape[1]) +
                             3 * k / static_cast<double>(lattice.shape[2]));
        return by * entry / (lattice.shape[0] - 1.0) * (1.25 + 0.25 * std::sin(turn));
    };
}

/// Where a point of the carved space comes from, straight from METHOD 4; nothing if it is freed.
std::optional<Vec3d> source_of(const CarveMap& map, Vec3d at) {
    const auto& step = map.steps().front();
    if (!step.carves(at, 1)) return std::nullopt;
    const StepColumns columns(step, at);
    const int low = static_cast<int>(at.x());
    const double part = at.x() - low, below = columns.displacement(low),
                 above = part > 0 ? columns.displacement(low + 1) : below;
    at.x() = step.clamped(at.x() + below + part * (above - below));
    return at;
}

}  // namespace

TEST_CASE(
    "a round trail gets thinner or thicker from all sides alike, and what lies beyond the lattice "
    "stays bit for bit") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const auto lattice = helix_lattice();
    const Mapping before(lattice, {lattice.shape[0] + 6, lattice.shape[1], lattice.shape[2]});
    const auto thick = [&](const Vec3d& p) {
        const auto place = before.locate(p);
        return place ? static_cast<float>(std::clamp(7 - place->x(), 0.0, 1.0)) : 0.0f;
    };
    const FloatGrid::ConstPtr grid = field_in(lattice, 0.08, thick);
    const auto map =
        soft_map_of(lattice,
                    straight_seams(lattice, Axis::u, kind,
                                   kind == Kind::remove ? std::vector{3, 3} : std::vector{3, 4}),
                    3);
    const auto carved =
        openvdb::GridBase::grid<FloatGrid>(carve_grid(grid, lattice, map, Interpolation::linear));
    auto values = carved->getConstAccessor();
    // The radius at which the trail falls to one half, in directions all around and all along.
    const double want = kind == Kind::remove ? 4.5 : 8.5;
    double least = 100, most = 0;
    for (int k = 4; k < lattice.shape[2] - 4; k += 3)
        for (int j = 0; j < lattice.shape[1]; j += 3) {
            double u = 0.5;
            const auto value = [&] {
                return openvdb::tools::BoxSampler::sample(
                    values, carved->worldToIndex(before.position(Vec3d(u, j, k))));
            };
            while (value() > 0.5) u += 0.02;
            least = std::min(least, u);
            most = std::max(most, u);
        }
    CHECK(least > want - 0.3);
    CHECK(most < want + 0.3);
    const Mapping inside(lattice, map.reach());
    int changed = 0;
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel)
        if (!inside.locate(grid->indexToWorld(voxel.getCoord())))
            changed += values.getValue(voxel.getCoord()) != *voxel;
    CHECK(changed == 0);
}

TEST_CASE(
    "every voxel around a rig comes from where the map of seams or of a warp says, across the "
    "closing of v and on the rig") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const bool by_warp = GENERATE(false, true);
    for (const auto& lattice : {helix_lattice(), ring_lattice()}) {
        const Vec3d slope(1, -0.5, 0.25);
        const auto linear = [&](const Vec3d& at) { return static_cast<float>(20 + slope.dot(at)); };
        const FloatGrid::ConstPtr grid = field_in(lattice, 0.09, linear);
        const auto seams = by_warp
                               ? warped(lattice, uneven(lattice, kind == Kind::remove ? -2.2 : 1.7))
                               : wandering(lattice, kind, 2, 1);
        const auto map = soft_map_of(lattice, seams, 3);
        const auto carved = openvdb::GridBase::grid<FloatGrid>(
            carve_grid(grid, lattice, map, Interpolation::linear));
        const Mapping mapping(lattice, map.reach());
        auto values = carved->getConstAccessor();
        int moved = 0, near = 0, closing = 0, inactive = 0;
        double worst = 0;
        for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
            const auto p = grid->indexToWorld(voxel.getCoord());
            const auto place = mapping.locate(p);
            const auto source = place ? source_of(map, *place) : std::nullopt;
            if (!source) continue;
            const double want = linear(p + mapping.position(*source) - mapping.position(*place));
            inactive += !values.isValueOn(voxel.getCoord());
            worst = std::max(worst, std::abs(values.getValue(voxel.getCoord()) - want));
            moved += *source != *place;
            near += place->x() < 1;
            closing += place->y() > lattice.shape[1] - 1;
        }
        CHECK(inactive == 0);
        CHECK(worst < 2e-4);
        CHECK(moved > 10000);
        CHECK(near > 300);
        CHECK(closing > 300);
    }
}

TEST_CASE(
    "on the rig no voxel is lost or torn: it stays, its neighbours stay beside it, and each place "
    "has one source and one goal",
    "[long]") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const double soft = GENERATE(0, 3);
    const int count = 3;
    const auto lattice = helix_lattice();
    const double voxel = 0.08;
    const auto map = soft_map_of(lattice, wandering(lattice, kind, count, 1), soft);
    const Mapping mapping(lattice, map.reach());
    // The voxels beside the rig, each with how far from it.
    std::vector<std::pair<openvdb::Coord, double>> beside;
    for (int axis = 0; axis < 3; ++axis) {
        // Each voxel holds one of its coordinates, so that the carve tells where its content comes
        // from.
        const FloatGrid::ConstPtr grid = field_in(
            lattice, voxel, [&](const Vec3d& at) { return static_cast<float>(10 + at[axis]); });
        if (beside.empty())
            for (auto at = grid->cbeginValueOn(); at; ++at) {
                const auto place = mapping.locate(grid->indexToWorld(at.getCoord()));
                if (place && place->x() <= 1 && place->z() >= 1 &&
                    place->z() <= lattice.shape[2] - 2)
                    beside.emplace_back(at.getCoord(), place->x());
            }
        const auto carved = openvdb::GridBase::grid<FloatGrid>(
            carve_grid(grid, lattice, map, Interpolation::linear));
        auto values = carved->getConstAccessor();
        const auto was = grid->getConstAccessor();
        int inactive = 0, far = 0, torn = 0;
        for (const auto& [voxel_at, distance] : beside) {
            inactive += !values.isValueOn(voxel_at);
            // Beside the rig, content comes from at most so many times as far from it.
            far += std::abs(values.getValue(voxel_at) - was.getValue(voxel_at)) >
                   count * distance * lattice.spacing + 1e-3;
            for (int c = 0; c < 3; ++c) {
                auto next = voxel_at;
                ++next[c];
                torn += std::abs(values.getValue(next) - values.getValue(voxel_at)) >
                        (1 + 2 * count) * voxel;
            }
        }
        CHECK(inactive == 0);
        CHECK(far == 0);
        CHECK(torn == 0);
        CHECK(beside.size() > 200);
    }
    if (soft == 0) return;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int n = 0; n < 5000; ++n) {
        const Vec3d place(2 * unit(random), lattice.shape[1] * unit(random),
                          (lattice.shape[2] - 1) * unit(random));
        const auto to = carved_coordinates(map, place);
        REQUIRE(to.x() >= 0);
        REQUIRE((source_of(map, to).value() - place).length() < 1e-6);
        const Vec3d rig(0, place.y(), place.z());
        REQUIRE(carved_coordinates(map, rig) == rig);
    }
}

TEST_CASE("smoothed displacements close around a rig: turned seams give turned displacements") {
    const auto lattice = helix_lattice();
    const int turn = lattice.shape[1];
    auto seams = no_seams(lattice), turned = seams;
    std::vector<std::uint16_t> one, other;
    const auto entry = [&](int j) {
        return static_cast<std::uint16_t>(3 + (j % turn < 3          ? j % turn
                                               : j % turn > turn - 3 ? turn - j % turn
                                                                     : 3));
    };
    for (int k = 0; k < lattice.shape[2]; ++k)
        for (int j = 0; j < turn; ++j) {
            one.push_back(entry(j));
            other.push_back(entry(j + 20));
        }
    seams.seams.push_back({one, 0.0});
    turned.seams.push_back({other, 0.0});
    const auto a = soft_map_of(lattice, seams, 3), b = soft_map_of(lattice, turned, 3);
    for (int j = 0; j < turn; ++j)
        for (int e = 0; e < lattice.shape[0] - 1; ++e)
            REQUIRE(a.steps()[0].soft()->entry(e, (j + 20) % turn, 5) ==
                    Approx(b.steps()[0].soft()->entry(e, j, 5)).margin(1e-6));
    // There is no rim across v at which content could tear, nor one on the rig.
    Volume volume;
    volume.grids.push_back(field_in(lattice, 0.1, [](const Vec3d&) { return 1.0f; }));
    for (const auto& tear : find_tears(volume, lattice, a))
        CHECK((tear.rim[0] == 'w' || tear.rim == "u = " + std::to_string(lattice.shape[0] - 1)));
    auto faded = soft_map_of(lattice, seams, 3);
    faded.fade_rims(5);
    CHECK(faded.steps()[0].rim_scale(Vec3d(3, 0, 60)) == 1);
    CHECK(faded.steps()[0].rim_scale(Vec3d(3, 20, 0)) == 0);
}

TEST_CASE("seams are found along the cells around a rig, also where v closes") {
    const auto lattice = helix_lattice();
    const auto map = soft_map_of(lattice, wandering(lattice, Kind::remove, 1, 2), 0);
    int along = 0;
    for (int j = 0; j < lattice.shape[1]; ++j) {
        // Between the last column and the first, too.
        const Vec3d at(2 + std::lround(1 + std::sin(4 * M_PI * j / lattice.shape[1])) - 0.5,
                       j + 0.5, 0.001);
        along += along_seam(map, at);
    }
    CHECK(along == lattice.shape[1]);
}

TEST_CASE(
    "a density around a rig keeps its mass, and particles keep their density, when it gets thinner "
    "or thicker, by seams or by a warp",
    "[long]") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const bool by_warp = GENERATE(false, true);
    const auto lattice = helix_lattice();
    const Mapping mapping(lattice);
    const auto cloud = [&](const Vec3d& p) {
        const auto place = mapping.locate(p);
        return place ? static_cast<float>(std::max(0.0, 1 - place->x() / 5.5)) : 0.0f;
    };
    Volume source;
    source.grids.push_back(field_in(lattice, 0.08, cloud));
    const double by = kind == Kind::remove ? -2 : 2;
    const auto even = [&](int entry, int, int, int) {
        return by * entry / (lattice.shape[0] - 1.0);
    };
    const auto map =
        soft_map_of(lattice, by_warp ? warped(lattice, even) : wandering(lattice, kind, 2, 1), 3);
    const auto carved = finished(source, carve_volume(source, lattice, map, Interpolation::linear),
                                 lattice, map, {std::nullopt, {"density"}, false});
    const auto sum = [](const Volume& volume) {
        double out = 0;
        for (auto value = openvdb::GridBase::grid<FloatGrid>(volume.grids[0])->cbeginValueOn();
             value; ++value) {
            if (!std::isfinite(*value)) return std::numeric_limits<double>::quiet_NaN();
            out += *value;
        }
        return out;
    };
    CHECK(sum(carved) == Approx(sum(source)).epsilon(0.05));

    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<Vec3d> points;
    std::vector<std::uint64_t> identities;
    const double end = lattice.shape[2] - 1, radius = kind == Kind::remove ? 8.99 : 8.5;
    for (std::uint64_t n = 0; n < 40000; ++n) {
        points.push_back(mapping.position({radius * std::sqrt(unit(random)),
                                           lattice.shape[1] * unit(random), end * unit(random)}));
        identities.push_back(n);
    }
    const auto moved = carve_points(points, identities, lattice, map, default_jitter);
    // The even density stays: as many as fit into the volume that is left or made.
    const double after = by_warp ? radius * (1 + by / (lattice.shape[0] - 1)) : radius + by,
                 share = after * after / (radius * radius);
    CHECK(static_cast<double>(moved.images.size()) == Approx(share * 40000).epsilon(0.05));
}

TEST_CASE(
    "a solver leaves out the rig, closes its seams around it, and refuses what would move the "
    "rig") {
    const auto lattice = around(through({{8, 8, 0}, {8, 8, 12}}, false, {0, 1, 0}), 6, 1);
    std::mt19937 random(3);
    const auto energy = energy_grid(CoordBBox(Coord(0), Coord(16, 16, 12)), [&](const Coord&) {
        return static_cast<float>(random() % 64);
    });
    const auto with = [&](const std::string& yaml) {
        return solve(seam_greedy(), yaml, {energy}, {lattice}, {}, 1);
    };
    const auto found = with("{count: -3}").seams;
    CHECK(found->around);
    for (const auto& seam : found->seams)
        for (int k = 0; k < lattice.shape[2]; ++k)
            for (int j = 0; j < lattice.shape[1]; ++j) {
                const auto row = static_cast<std::size_t>(k * lattice.shape[1]);
                const int here = seam.at[row + static_cast<std::size_t>(j)],
                          next =
                              seam.at[row + static_cast<std::size_t>((j + 1) % lattice.shape[1])];
                REQUIRE(here >= 1);
                REQUIRE(std::abs(here - next) <= 1);
            }
    CHECK_THROWS_WITH(with("{count: -3, axis: v}"),
                      "the lattice goes around its rig, so that v closes and has no end to take "
                      "from: carve `axis: u`");
    CHECK_THROWS_WITH(with("{count: -3, anchor: high}"),
                      "anchor high would move the rig, which the lattice goes around and where all "
                      "its columns meet: leave `anchor` out, so that the rig stays "
                      "in place");
    CHECK_THROWS_WITH(with("{count: -3, window: [0, 4]}"),
                      "window [0, 4] holds the rig, vertex 0, where the lattice's columns meet, so "
                      "that nothing can be taken or added; begin at 1");
}

TEST_CASE(
    "a warp around a rig holds the rig, knows no first column, and refuses what would move the "
    "rig") {
    const auto lattice = around(through({{8, 8, 0}, {8, 8, 12}}, false, {0, 1, 0}), 6, 1);
    const int half = lattice.shape[1] / 2;
    REQUIRE(2 * half == lattice.shape[1]);
    // The same after half a turn.
    const auto noise = [](int x, int y, int z) {
        return static_cast<unsigned>(x * 73 + y * 19 + z * 7) * 2654435761u % 64;
    };
    const auto energy = energy_grid(CoordBBox(Coord(0), Coord(16, 16, 12)), [&](const Coord& at) {
        return static_cast<float>(noise(at.x(), at.y(), at.z()) +
                                  noise(16 - at.x(), 16 - at.y(), at.z()));
    });
    const auto with = [&](const std::string& yaml) {
        return solve(warp_solve(), yaml, {energy}, {lattice}, {}, 1);
    };
    const auto found = with("{amount: -2.5}").seams;
    REQUIRE(found->warp);
    CHECK(found->around);
    double differ = 0;
    for (int k = 0; k < lattice.shape[2]; ++k)
        for (int j = 0; j < half; ++j) {
            std::vector<float> here(7), there(7), next(7);
            found->warp->column(0, j, k, here);
            found->warp->column(0, j + half, k, there);
            found->warp->column(0, j + 1, k, next);
            REQUIRE((here.front() == 0 && here.back() == -2.5f));
            for (std::size_t u = 0; u < 7; ++u) {
                REQUIRE(here[u] == Approx(there[u]).margin(1e-3));
                differ = std::max(differ, static_cast<double>(std::abs(here[u] - next[u])));
            }
        }
    CHECK(differ > 0.05);
    CHECK_THROWS_WITH(
        with("{amount: -3, axis: v}"),
        Catch::Contains(
            "the lattice goes around its rig, so that v closes and has no end to take from"));
    CHECK_THROWS_WITH(with("{amount: -3, anchor: middle}"),
                      Catch::Contains("anchor middle would move the rig"));
}
