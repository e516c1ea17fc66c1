#include "carve/remap/grid.h"
#include "nodes/params/rim.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/reference_carve.h"
#include "tests/support/sampled.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/task_arena.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec2d;
using openvdb::Vec3d;

namespace {

CarveMap map_of(const Lattice& lattice, const Seams& seams, const Softness& softness = {}) {
    return {lattice, {std::make_shared<Seams>(seams)}, 1, {}, std::vector{softness}};
}

FloatGrid::Ptr field_around(const Lattice& lattice, double voxel,
                            const std::function<float(const Vec3d&)>& value) {
    const auto box = Mapping(lattice).world_box(
        BBoxd(Vec3d(0), Vec3d(lattice.shape[0] - 1, lattice.shape[1] - 1, lattice.shape[2])));
    return sampled<FloatGrid>(CoordBBox(Coord::floor(box.min() / voxel).offsetBy(-6),
                                        Coord::ceil(box.max() / voxel).offsetBy(6)),
                              voxel, value);
}

/// The greatest difference of two grids' values in a box; states must agree.
template <class Grid>
double difference(const Grid& a, const Grid& b, const CoordBBox& box) {
    double out = 0;
    auto x = a.getConstAccessor(), y = b.getConstAccessor();
    for (auto at = box.begin(); at; ++at) {
        if (x.isValueOn(*at) != y.isValueOn(*at)) return 1e9;
        if constexpr (openvdb::VecTraits<typename Grid::ValueType>::IsVec)
            out = std::max<double>(out, (x.getValue(*at) - y.getValue(*at)).length());
        else out = std::max<double>(out, std::abs(x.getValue(*at) - y.getValue(*at)));
    }
    return out;
}

/// How far outward from the middle of a horizontal ring the grid falls below one half, in
/// directions all around.
std::vector<double> outline(const FloatGrid& grid, const Vec3d& centre, double from, double step) {
    std::vector<double> out;
    auto values = grid.getConstAccessor();
    for (int n = 0; n < 720; ++n) {
        const double angle = -2 * M_PI * n / 720;
        const auto value = [&](double radius) {
            return openvdb::tools::BoxSampler::sample(
                values, grid.worldToIndex(
                            centre + Vec3d(radius * std::cos(angle), radius * std::sin(angle), 0)));
        };
        double radius = from;
        while (value(radius + step) >= 0.5 && std::abs(radius - from) < 50) radius += step;
        const double high = value(radius), low = value(radius + step);
        out.push_back(radius + step * (high - 0.5) / (high - low));
    }
    return out;
}

}  // namespace

TEST_CASE("without seams a grid comes back from every lattice as it is") {
    std::mt19937 random(1);
    for (const auto& lattice :
         {random_bent(random, true), random_bent(random, false), helix({7, 5, 60}, 0.4, 5, 1),
          as_planes(make_box(Vec3d(0), {8, 8, 8}, 1.0, {0, 1, 2})),
          ring(Vec3d(0), {9, 7, 40}, 0.5, Vec2d(-2, -1))}) {
        const FloatGrid::ConstPtr grid = field_around(lattice, lattice.spacing, swirl);
        CHECK(carve_grid(grid, lattice,
                         map_of(lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove, {})),
                         Interpolation::linear) == grid);
        const FloatGrid::ConstPtr flat = FloatGrid::create(0.5f);
        CHECK(
            carve_grid(flat, lattice,
                       map_of(lattice, straight_seams(lattice, Axis::v, Seams::Kind::insert, {2})),
                       Interpolation::linear) == flat);
    }
}

TEST_CASE(
    "in a bent lattice, what lies outside or before the seams stays bit for bit, and the rest "
    "moves along u") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const Vec3d centre(0.3, 0.2, 0.1), slope(1, -0.5, 0.25);
    const auto lattice = ring(centre, {20, 9, 120}, 0.25, Vec2d(-2, -1));
    const auto linear = [&](const Vec3d& at) { return static_cast<float>(slope.dot(at)); };
    const FloatGrid::ConstPtr grid = field_around(lattice, 0.2, linear);
    const auto map = map_of(
        lattice,
        straight_seams(lattice, Axis::u, kind,
                       kind == Seams::Kind::remove ? std::vector{7, 7, 7} : std::vector{7, 8, 9}));
    const auto got = carved<FloatGrid>(grid, lattice, map);
    const Mapping mapping(lattice, map.reach());
    int kept = 0, moved = 0, freed = 0;
    for (auto voxel = grid->cbeginValueAll(); voxel; ++voxel) {
        if (!voxel.isVoxelValue()) continue;
        const auto p = grid->indexToWorld(voxel.getCoord());
        const auto place = mapping.locate(p);
        const float value = got->tree().getValue(voxel.getCoord());
        if (!place || place->x() <= 6) {
            ++kept;
            REQUIRE(value == *voxel);
            REQUIRE(got->tree().isValueOn(voxel.getCoord()) == voxel.isValueOn());
        } else if (kind == Seams::Kind::remove && place->x() > 16) {
            ++freed;
            REQUIRE(value == 0.0f);
        } else if (kind == Seams::Kind::remove ? place->x() > 7 : place->x() > 14) {
            ++moved;
            const auto source = *place + Vec3d(kind == Seams::Kind::remove ? 3 : -3, 0, 0);
            REQUIRE(value == Approx(linear(p + mapping.position(source) - mapping.position(*place)))
                                 .margin(1e-5));
        }
    }
    CHECK(kept > 10000);
    CHECK(moved > 5000);
    CHECK((freed > 2000 || kind == Seams::Kind::insert));
}

TEST_CASE(
    "a ring carved inside its wall moves its outer rim by the number of seams, everywhere alike, "
    "softly too") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const double soft = GENERATE(0.0, 3.0);
    const double spacing = 0.5;
    const Vec3d centre(0.13, -0.21, 0.07);
    const auto lattice = ring(centre, {29, 9, 180}, spacing, Vec2d(-7, -2));
    const double rig = ring_radius(180, spacing), inner = rig - 4.3, outer = rig + 3.7;
    const FloatGrid::ConstPtr grid = field_around(lattice, spacing, [&](const Vec3d& at) {
        const double radius = std::hypot(at.x() - centre.x(), at.y() - centre.y());
        return static_cast<float>(
            std::clamp(0.5 + std::min(outer - radius, radius - inner) / 2, 0.0, 1.0));
    });
    // Vertex 14 is on the rig; the wall is solid from 8 to 19.
    const int count = 6;
    const auto map =
        map_of(lattice,
               straight_seams(lattice, Axis::u, kind,
                              kind == Seams::Kind::remove ? std::vector<int>(count, 11)
                                                          : std::vector{10, 11, 12, 13, 14, 15}),
               {soft, 0});
    const auto got = carved<FloatGrid>(grid, lattice, map);

    const auto rim = outline(*got, centre, rig, 0.1), before = outline(*grid, centre, rig, 0.1);
    const double by = (kind == Seams::Kind::remove ? -count : count) * spacing;
    double low = 1e9, high = -1e9, step = 0;
    for (std::size_t n = 0; n < rim.size(); ++n) {
        CHECK(std::abs(rim[n] - (outer + by)) < 0.1 * spacing);
        low = std::min(low, rim[n] - before[n]);
        high = std::max(high, rim[n] - before[n]);
        if (n > 0) step = std::max(step, std::abs(rim[n] - rim[n - 1]));
    }
    CHECK(high - low < 0.1 * spacing);
    CHECK(std::abs(rim.front() - rim.back()) <= step);
    CHECK(outline(*got, centre, rig, -0.1) == outline(*grid, centre, rig, -0.1));
}

TEST_CASE("a closed lattice has no first plane: seams and grids do not know where it begins") {
    std::mt19937 random(9);
    for (int n = 0; n < 6; ++n) {
        const auto lattice = random_bent(random, true);
        if (lattice.shape[0] < 6 || lattice.shape[1] < 6) continue;
        auto grid = field_around(lattice, lattice.spacing * 0.9, swirl);
        const auto axis = n % 2 ? Axis::u : Axis::v;
        const auto seams = random_seams(random, lattice, lattice.shape, axis,
                                        n % 3 ? Seams::Kind::remove : Seams::Kind::insert, 3, {1});

        const int shift =
            1 + static_cast<int>(random() % static_cast<unsigned>(lattice.shape[2] - 1));
        auto planes = lattice.planes;
        std::rotate(planes.begin(), planes.begin() + shift, planes.end());
        const auto shifted = with_planes(lattice.shape, lattice.spacing, true, planes, "shifted");
        auto shifted_seams = seams;
        shifted_seams.lattice_hash = shifted.hash;
        for (auto& seam : shifted_seams.seams)
            std::rotate(seam.at.all().begin(), seam.at.all().begin() + shift * seams.laterals(),
                        seam.at.all().end());

        const auto a = carved<FloatGrid>(grid, lattice, map_of(lattice, seams)),
                   b = carved<FloatGrid>(grid, shifted, map_of(shifted, shifted_seams));
        INFO("case " << n);
        CHECK(a != FloatGrid::ConstPtr(grid));
        CHECK(difference(*a, *b, grid->evalActiveVoxelBoundingBox()) < 1e-4);
    }
}

TEST_CASE("a straight lattice of planes is carved as a box is") {
    std::mt19937 random(10);
    const auto interpolation = GENERATE(Interpolation::linear, Interpolation::cubic);
    const auto box = make_box(Vec3d(0.1, 0.2, 0.3), {15, 14, 13}, 0.4, {2, 0, 1});
    const auto planes = as_planes(box);
    const CoordBBox voxels(Coord(-5), Coord(24));
    auto grid = sampled<FloatGrid>(voxels, 0.3, swirl);
    grid->transform().postRotate(0.2, openvdb::math::Z_AXIS);
    auto velocity = sampled_staggered(voxels, 0.3, [](const Vec3d& at) {
        return openvdb::Vec3s(swirl(at), swirl(2.0 * at), swirl(0.5 * at));
    });
    for (int n = 0; n < 6; ++n) {
        const auto axis = static_cast<Axis>(n % 3);
        auto seams = random_seams(random, box, box.shape, axis,
                                  n % 2 ? Seams::Kind::remove : Seams::Kind::insert, 4, {1});
        const auto straight = map_of(box, seams);
        seams.lattice_hash = planes.hash;
        const auto general = map_of(planes, seams);
        CHECK(difference(*carved<FloatGrid>(grid, box, straight, interpolation),
                         *carved<FloatGrid>(grid, planes, general, interpolation), voxels) < 1e-5);
        CHECK(difference(*carved<VectorGrid>(velocity, box, straight, interpolation),
                         *carved<VectorGrid>(velocity, planes, general, interpolation),
                         voxels) < 1e-5);
    }
}

TEST_CASE(
    "chains along all axes carve a straight lattice of planes as they carve a box, whatever the "
    "anchors") {
    std::mt19937 random(11);
    const auto box = make_box(Vec3d(0.1, 0.2, 0.3), {15, 14, 13}, 0.4, {2, 0, 1});
    const auto planes = as_planes(box);
    const CoordBBox voxels(Coord(-8), Coord(26));
    const auto grid = sampled<FloatGrid>(voxels, 0.3, swirl);
    for (int n = 0; n < 24; ++n) {
        std::vector<Ref<Seams>> of_box, of_planes;
        auto shape = box.shape;
        for (int step = 0; step < 3; ++step) {
            auto seams =
                random_seams(random, box, shape, static_cast<Axis>(random() % 3),
                             random() % 2 ? Seams::Kind::remove : Seams::Kind::insert, 3, {1});
            for (auto& each : seams.seams)
                each = straight_seam(seams, static_cast<int>(random() % 5));
            if (seams.kind == Seams::Kind::insert)
                for (int s = 0; s < 3; ++s)
                    seams.seams[static_cast<std::size_t>(s)] = straight_seam(seams, 2 + s);
            seams.anchor = {
                std::array{Anchor::At::low, Anchor::At::middle, Anchor::At::high}[random() % 3], 0};
            seams.find_shifts();
            shape = seams.shape_after(3);
            of_box.push_back(std::make_shared<Seams>(seams));
            seams.lattice_hash = planes.hash;
            of_planes.push_back(std::make_shared<Seams>(seams));
        }
        INFO("case " << n);
        const CarveMap straight(box, of_box, 1, {}), general(planes, of_planes, 1, {});
        CHECK(difference(*carved<FloatGrid>(grid, box, straight),
                         *carved<FloatGrid>(grid, planes, general), voxels) < 1e-5);
    }
}

TEST_CASE(
    "a bar of ten voxels is gone after ten seams in a lattice that is turned by seven degrees") {
    auto lattice = make_box(Vec3d(0), {40, 30, 6}, 1.0, {0, 1, 2});
    const double angle = 7 * M_PI / 180;
    for (auto& plane : lattice.planes)
        for (auto* vector : {&plane.u, &plane.v})
            *vector = Vec3d(std::cos(angle) * vector->x() - std::sin(angle) * vector->y(),
                            std::sin(angle) * vector->x() + std::cos(angle) * vector->y(), 0);
    lattice.hash = lattice_hash(lattice);
    REQUIRE(lattice.is_box());
    for (const auto& turned : {lattice, as_planes(lattice)}) {
        const Mapping mapping(turned);
        const auto grid = sampled<FloatGrid>(
            CoordBBox(Coord(-20, -20, -2), Coord(60, 60, 8)), 1.0, [&](const Vec3d& at) {
                const double u = std::cos(angle) * at.x() + std::sin(angle) * at.y();
                return u > 14.5 && u < 24.5 ? 1.0f : 0.0f;
            });
        const auto got = carved<FloatGrid>(
            grid, turned,
            map_of(turned,
                   straight_seams(turned, Axis::u, Seams::Kind::remove, std::vector<int>(10, 15))));
        int shining = 0, inside = 0;
        for (auto voxel = got->cbeginValueAll(); voxel; ++voxel)
            if (voxel.isVoxelValue() && mapping.locate(got->indexToWorld(voxel.getCoord()))) {
                ++inside;
                shining += *voxel > 0.5f;
            }
        CHECK(inside > 4000);
        CHECK(shining == 0);
    }
}

TEST_CASE("the paper's closed form moves a ring's rim too, but less evenly") {
    const Vec3d centre(0.13, -0.21, 0.07);
    const auto lattice = ring(centre, {29, 9, 60}, 0.5, Vec2d(-1, -2));
    const double outer = ring_radius(60, 0.5) + 8.7;
    const FloatGrid::ConstPtr grid = field_around(lattice, 0.5, [&](const Vec3d& at) {
        return static_cast<float>(std::clamp(
            0.5 + (outer - std::hypot(at.x() - centre.x(), at.y() - centre.y())) / 2, 0.0, 1.0));
    });
    const auto uneven = [&](bool closed_form) {
        auto used = lattice;
        used.closed_form = closed_form;
        used.hash = lattice_hash(used);
        const auto got = carved<FloatGrid>(
            grid, used,
            map_of(used,
                   straight_seams(used, Axis::u, Seams::Kind::remove, std::vector<int>(6, 4))));
        const auto rim = outline(*got, centre, outer - 5, 0.1);
        const auto [low, high] = std::ranges::minmax_element(rim);
        CHECK(std::abs(*low - (outer - 3)) < 0.25);
        CHECK(std::abs(*high - (outer - 3)) < 0.25);
        return *high - *low;
    };
    CHECK(uneven(true) > 1.5 * uneven(false));
}

TEST_CASE("the result does not depend on the number of threads") {
    std::mt19937 random(11);
    const auto lattice = ring(Vec3d(0), {18, 10, 90}, 0.5, Vec2d(-4, -2));
    const auto grid = field_around(lattice, 0.4, swirl);
    const auto map = map_of(lattice, random_seams(random, lattice, lattice.shape, Axis::u,
                                                  Seams::Kind::remove, 5, {1}));
    FloatGrid::ConstPtr one, four;
    tbb::task_arena(1).execute([&] { one = carved<FloatGrid>(grid, lattice, map); });
    tbb::task_arena(4).execute([&] { four = carved<FloatGrid>(grid, lattice, map); });
    CHECK(one != FloatGrid::ConstPtr(grid));
    CHECK(difference(*one, *four, grid->evalActiveVoxelBoundingBox()) == 0);
}
