#include "carve/remap/finish/level_set.h"
#include "carve/remap/finish/finish.h"
#include "carve/remap/finish/squeezed.h"
#include "carve/remap/grid.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/seam_cells.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"
#include "tests/support/warped.h"
#include "tests/support/wavy_seams.h"

#include <openvdb/tools/LevelSetSphere.h>
#include <tbb/task_arena.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec2d;
using openvdb::Vec3d;

namespace {

constexpr float band = 3;

/// A level set of a ball in voxels of 1: beyond the band inactive, outside `band`, inside `-band`.
template <class Grid = FloatGrid>
typename Grid::Ptr ball(const Vec3d& centre, double radius) {
    const auto out = openvdb::tools::createLevelSetSphere<Grid>(static_cast<float>(radius),
                                                                openvdb::Vec3f(centre), 1.0f, band);
    out->setName("surface");
    return out;
}

struct Result {
    FloatGrid::ConstPtr carved, got;
};
Result carve_level_set(const FloatGrid::ConstPtr& grid, const Lattice& lattice, const CarveMap& map,
                       std::optional<bool> renormalize = {}) {
    const auto source = volume_of(grid),
               carved = carve_volume(source, lattice, map, Interpolation::linear);
    Finish finish;
    finish.renormalize = renormalize;
    const auto got = finished(source, carved, lattice, map, finish);
    return {openvdb::GridBase::grid<FloatGrid>(carved.grids[0]),
            openvdb::GridBase::grid<FloatGrid>(got.grids[0])};
}

/// How far the gradients' lengths are from 1 near the surface, where all neighbours moved too.
struct Slopes {
    double rms = 0, least = 9, most = 0;
    int count = 0;
};
template <class Moved>
Slopes slopes(const FloatGrid& grid, const Moved& moved) {
    Slopes out;
    const auto values = grid.getConstAccessor();
    for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
        if (std::abs(*voxel) > 1.8) continue;
        bool all = true;
        for (auto near =
                 CoordBBox(voxel.getCoord().offsetBy(-1), voxel.getCoord().offsetBy(1)).begin();
             near; ++near)
            all = all && moved(*near);
        if (!all) continue;
        Vec3d gradient;
        for (int axis = 0; axis < 3; ++axis) {
            auto low = voxel.getCoord(), high = low;
            --low[axis];
            ++high[axis];
            gradient[axis] = (values.getValue(high) - values.getValue(low)) / 2;
        }
        const double length = gradient.length();
        out.rms += (length - 1) * (length - 1);
        out.least = std::min(out.least, length);
        out.most = std::max(out.most, length);
        ++out.count;
    }
    out.rms = std::sqrt(out.rms / out.count);
    return out;
}

}  // namespace

TEST_CASE(
    "a level set carved through a bent or turned lattice is a distance again where it moved, and "
    "untouched elsewhere") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const bool bent = GENERATE(false, true);
    const auto lattice =
        bent ? ring(Vec3d(0), {50, 50, 200}, 1.0, Vec2d(-25, -25))
             : turned(make_box(Vec3d(-35, -30, -30), {70, 60, 60}, 1.0, {0, 1, 2}), 0.35);
    const Vec3d centre = bent ? Vec3d(ring_radius(200, 1), 0, 0) : Vec3d(0);
    const auto grid = ball(centre, 18);
    REQUIRE(!grid->tree().probeConstLeaf(Coord::round(centre)));
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, kind, bent ? 20 : 33, 6, 2)});
    const auto [carved, got] = carve_level_set(grid, lattice, map);

    const Mapping mapping(lattice, map.reach());
    const auto moved = [&](const Coord& at) {
        const auto place = mapping.locate(at.asVec3d());
        return place && is_moved(map, *place);
    };
    auto box = carved->evalActiveVoxelBoundingBox();
    box.expand(4);
    auto before = carved->getConstAccessor(), after = got->getConstAccessor();
    int kept = 0, renewed = 0, inside = 0;
    for (auto at = box.begin(); at; ++at) {
        const float value = after.getValue(*at);
        REQUIRE((value < 0) == (before.getValue(*at) < 0));
        if (!moved(*at)) {
            ++kept;
            REQUIRE(same_bits(value, before.getValue(*at)));
            REQUIRE(after.isValueOn(*at) == before.isValueOn(*at));
            continue;
        }
        ++renewed;
        REQUIRE((std::abs(value) < band) == after.isValueOn(*at));
        if (!after.isValueOn(*at)) REQUIRE(std::abs(value) == band);
        inside += value == -band;
    }
    CHECK(kept > 10000);
    CHECK(renewed > 10000);
    CHECK(inside > 2000);
    CHECK(got->background() == band);
    CHECK(got->getGridClass() == openvdb::GRID_LEVEL_SET);

    const auto was = slopes(*carved, moved), is = slopes(*got, moved);
    CHECK(is.count > 1000);
    CHECK(is.rms < 0.02);
    CHECK(is.rms < was.rms / 2);
    // Where seams took all that was between them, the surface has an edge, and no gradient.
    CHECK(is.least > 0.7);
    CHECK(is.most < 1.15);
}

TEST_CASE("beyond the seams a carved ball is the ball's other half, to a hundredth of a voxel") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const double angle = 0.35;
    const auto lattice =
        turned(make_box(Vec3d(-35, -30, -30), {80, 60, 60}, 1.0, {0, 1, 2}), angle);
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, kind, 33, 6, 0)});
    const auto got = carve_level_set(ball(Vec3d(0), 20), lattice, map).got;
    const Vec3d u(std::cos(angle), std::sin(angle), 0),
        centre = (kind == Seams::Kind::remove ? -6.0 : 6.0) * u;
    int count = 0;
    for (auto voxel = got->cbeginValueOn(); voxel; ++voxel) {
        const auto from = voxel.getCoord().asVec3d() - centre;
        if (std::abs(*voxel) > 2 || from.dot(u) < 12) continue;
        ++count;
        REQUIRE(*voxel == Approx(from.length() - 20).margin(0.012));
    }
    CHECK(count > 1000);
}

TEST_CASE("in an aligned box level sets become distances, too, unless they are to be left alone") {
    const auto lattice = make_box(Vec3d(-30), {60, 60, 60}, 1.0, {0, 1, 2});
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Seams::Kind::insert, 38, 6, 2)});
    const auto grid = ball(Vec3d(0), 20);
    const auto left = carve_level_set(grid, lattice, map, false);
    CHECK(left.got == left.carved);
    const auto [carved, got] = carve_level_set(grid, lattice, map);
    const Mapping mapping(lattice, map.reach());
    const auto moved = [&](const Coord& at) {
        const auto place = mapping.locate(at.asVec3d());
        return place && is_moved(map, *place);
    };
    const auto was = slopes(*carved, moved), is = slopes(*got, moved);
    CHECK(was.least < 0.8);
    CHECK(is.least > 0.9);
    CHECK(is.rms < was.rms / 4);
}

TEST_CASE("what a carve cuts off gets a narrow band of its own") {
    // The ball reaches far beyond the lattice's rim: removing frees a slab inside it.
    const auto lattice = turned(make_box(Vec3d(-20, -10, -10), {30, 21, 21}, 1.0, {0, 1, 2}), 0.2);
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Seams::Kind::remove, 12, 8, 0)});
    const auto [carved, got] = carve_level_set(ball(Vec3d(0), 40), lattice, map);
    const Mapping mapping(lattice, map.reach());
    int cut = 0, banded = 0, before = 0;
    for (auto at = CoordBBox(Coord(-25), Coord(25)).begin(); at; ++at) {
        const auto place = mapping.locate((*at).asVec3d());
        if (!place || place->x() < 18 || place->x() > 24 || place->y() < 4 || place->y() > 16 ||
            place->z() < 4 || place->z() > 16)
            continue;
        before += carved->tree().isValueOn(*at);
        ++cut;
        // All but the cut behind vertex 21 is farther than the band.
        const float value = got->tree().getValue(*at);
        REQUIRE((value < 0) == (place->x() <= 21));
        REQUIRE(got->tree().isValueOn(*at) == (std::abs(value) < band));
        REQUIRE(value == Approx(std::clamp(place->x() - 21, -3.0, 3.0)).margin(0.75));
        banded += got->tree().isValueOn(*at);
    }
    CHECK(before == 0);
    CHECK(cut > 500);
    CHECK(banded > cut / 2);
}

TEST_CASE(
    "level sets that no seam changes, or that are left alone, stay the carve's, and what can't be "
    "renormalised is said") {
    const auto lattice = turned(make_box(Vec3d(-10), {20, 20, 20}, 1.0, {0, 1, 2}), 0.2);
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Seams::Kind::remove, 9, 3, 1)});
    const auto far = FloatGrid::ConstPtr(ball(Vec3d(50, 0, 0), 10));
    CHECK(carve_level_set(far, lattice, map).got == far);

    const auto near = ball(Vec3d(0), 8);
    const auto left = carve_level_set(near, lattice, map, false);
    CHECK(left.got == left.carved);
    CHECK(left.carved != FloatGrid::ConstPtr(near));
    const auto smoke = near->deepCopy();
    smoke->setGridClass(openvdb::GRID_FOG_VOLUME);
    const auto fog = carve_level_set(smoke, lattice, map, true);
    CHECK(fog.got == fog.carved);

    const auto flat = near->deepCopy();
    flat->transform().postScale(Vec3d(1, 1, 0.5));
    const auto kept = carve_level_set(flat, lattice, map);
    CHECK(kept.got == kept.carved);
    CHECK(failure_of([&] { carve_level_set(flat, lattice, map, true); }) ==
          "level set 'surface' can't be renormalized: its voxels are not cubes, or its background "
          "is not above 0, or above 100 voxels");
}

TEST_CASE("level sets of doubles are renormalised, the same by any number of threads") {
    const auto lattice = turned(make_box(Vec3d(-20), {40, 40, 40}, 1.0, {0, 1, 2}), 0.2);
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Seams::Kind::insert, 24, 4, 1)});
    const auto source = volume_of(ball<openvdb::DoubleGrid>(Vec3d(0), 12)),
               carved = carve_volume(source, lattice, map, Interpolation::linear);
    Volume one, four;
    tbb::task_arena(1).execute([&] { one = finished(source, carved, lattice, map, {}); });
    tbb::task_arena(4).execute([&] { four = finished(source, carved, lattice, map, {}); });
    CHECK(one.grids[0] != carved.grids[0]);
    CHECK(difference(*one.grids[0].grid(), *four.grids[0].grid()).empty());
    // Drawn out by 4: the far end of the ball and its band.
    const auto& got = static_cast<const openvdb::DoubleGrid&>(*one.grids[0].grid());
    const Vec3d end = 16.0 * Vec3d(std::cos(0.2), std::sin(0.2), 0);
    CHECK(std::abs(got.tree().getValue(Coord::round(end)) -
                   (Coord::round(end).asVec3d() - 4.0 / 16 * end).length() + 12) < 0.02);
}

TEST_CASE("a level set is smoothed where it was squeezed, by the share that was lost, only there") {
    const auto lattice = make_box(Vec3d(0), {31, 14, 14}, 1.0, {0, 1, 2});
    const auto grid = ball(Vec3d(15, 6.5, 6.5), 5);
    const auto smoothed = [&](double by) {
        const auto map = map_of(lattice, {warped(lattice, evenly(lattice, by))});
        const auto extended = map.extended(lattice);
        const Mapping mapping(extended, map.reach());
        const auto carved = openvdb::gridConstPtrCast<FloatGrid>(
            carve_grid(grid, lattice, map, Interpolation::linear));
        const CarvedPlaces places(extended, map.reach(), carved->transform(), carved->transform());
        return std::pair(carved, openvdb::gridConstPtrCast<FloatGrid>(squeezed_smooth(
                                     carved, places, CarveDerivative(mapping, map))));
    };
    // 31 vertices become 21: a third is lost.
    const auto [carved, got] = smoothed(-10);
    CHECK(got->activeVoxelCount() == carved->activeVoxelCount());
    constexpr double part = 2.0 / 3 / 16;
    const std::array kernel{-part, 4 * part, 1 - 6 * part, 4 * part, -part};
    int count = 0;
    for (auto voxel = got->cbeginValueOn(); voxel; ++voxel) {
        const auto at = voxel.getCoord();
        if (at.x() < 1 || at.x() > 18 || at.y() < 0 || at.y() > 13 || at.z() < 0 || at.z() > 13)
            continue;
        double mean = 0;
        for (auto near = CoordBBox(Coord(-2), Coord(2)).begin(); near; ++near) {
            double weight = 1;
            for (int axis = 0; axis < 3; ++axis)
                weight *= kernel[static_cast<std::size_t>((*near)[axis] + 2)];
            mean += weight * carved->tree().getValue(at + *near);
        }
        REQUIRE(*voxel == Approx(mean).margin(1e-5));
        ++count;
    }
    CHECK(count > 500);
    const auto [stretched, kept] = smoothed(10);
    CHECK(kept == stretched);
}
