#include "carve/remap/finish/finish.h"
#include "carve/remap/finish/tears.h"
#include "carve/remap/geometry/mesh.h"
#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "carve/remap/seam_filter.h"
#include "carve/remap/voxels/sampled.h"
#include "nodes/filter.h"
#include "nodes/remap.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"
#include "tests/support/warped.h"
#include "tests/support/wavy_seams.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/global_control.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// A warp is carved by everything that carves seams.

namespace {

FloatGrid::Ptr grid_of(const CoordBBox& box, const std::function<double(const Vec3d&)>& value) {
    const auto out = FloatGrid::create(0);
    for (auto at = box.begin(); at; ++at)
        out->tree().setValueOn(*at, static_cast<float>(value((*at).asVec3d())));
    out->setName("density");
    return out;
}

FloatGrid::ConstPtr carved_by_warp(const FloatGrid::Ptr& grid, const Lattice& lattice,
                                   const Seams& seams) {
    return openvdb::gridConstPtrCast<FloatGrid>(
        carve_grid(grid, lattice, map_of(lattice, {seams}), Interpolation::linear));
}

/// Keeps its width up to `k = 4`, then changes it more and more.
Shift ramp(const Lattice& lattice, double most) {
    return [most, last = lattice.shape[0] - 1, end = lattice.shape[2] - 1](int entry, int, int k,
                                                                           int) {
        return most * std::max(0.0, (k - 4.0) / (end - 4)) * entry / last;
    };
}

/// Squeezes or widens by so much around the middle, in each column elsewhere.
Shift bump(const Lattice& lattice, double by) {
    return [by, size = lattice.shape[0]](int entry, int lateral, int k, int) {
        // The steepest slope is 0.8.
        const double x = (entry - 0.5 * size - std::sin(0.3 * lateral) - std::sin(0.2 * k)) /
                         (0.625 * std::abs(by));
        return by * (entry < 2 ? 0 : 0.5 + 0.5 * std::tanh(x));
    };
}

}  // namespace

TEST_CASE(
    "an even warp is even scaling, to a thousandth of a voxel, on the voxels and between them, "
    "along u, v and w") {
    const auto axis = GENERATE(Axis::u, Axis::v, Axis::w);
    const double by = GENERATE(-1.5, -7.25, 11.7);
    const double aside = GENERATE(0.0, 0.3);
    const auto lattice = make_box(Vec3d(aside), vertex_of(axis, 40, 9, 8), 1.0, {0, 1, 2});
    const int a = static_cast<int>(axis), b = static_cast<int>(slice_dimension(axis));
    const auto grid = grid_of({Coord(-2), Coord(42, 42, 42)},
                              [&](const Vec3d& at) { return at[a] + 0.1 * at[b]; });
    const auto out =
        carved_by_warp(grid, lattice, warped(lattice, evenly(lattice, by, axis), axis));
    for (int n = 1; n < static_cast<int>(39 + by); ++n) {
        Coord at(4, 4, 4);
        at[a] = n;
        CHECK(out->tree().getValue(at) ==
              Approx(aside + (n - aside) * 39 / (39 + by) + 0.4).margin(1e-3));
    }
}

TEST_CASE(
    "what a warp leaves behind is empty, and what it does not reach keeps its bits, in and beside "
    "the lattice") {
    const double by = GENERATE(-7.25, 6.5);
    const auto lattice = make_box(Vec3d(0), {40, 9, 12}, 1.0, {0, 1, 2});
    const auto grid = grid_of({Coord(-5), Coord(55, 14, 17)}, [](const Vec3d& at) {
        return 1 + std::sin(at.x()) * std::cos(0.3 * at.y() + at.z());
    });
    const auto out = carved_by_warp(grid, lattice, warped(lattice, ramp(lattice, by)));
    auto before = grid->getConstAccessor(), after = out->getConstAccessor();
    for (auto at = CoordBBox(Coord(-5), Coord(55, 14, 17)).begin(); at; ++at) {
        const int x = (*at).x(), y = (*at).y(), z = (*at).z();
        const bool beside = x < 0 || y < 0 || y > 8 || z < 0 || z > 11,
                   above = x > 39 + std::max(0.0, by * (z - 4) / 7) + 0.5;
        if (beside || above || z <= 4 || x == 0)
            REQUIRE((after.getValue(*at) == before.getValue(*at) && after.isValueOn(*at)));
        if (by < 0 && z == 11 && !beside && x < 40) REQUIRE(after.isValueOn(*at) == (x <= 32));
    }
    // The same through the nodes' points and meshes.
    const auto map = map_of(lattice, {warped(lattice, ramp(lattice, by))});
    const std::vector<Vec3d> positions{{10.3, 4.4, 3.9}, {39, 2, 4}, {10.3, 4.4, 9.9}};
    const auto points = carve_points(positions, {1, 2, 3}, lattice, map, default_jitter);
    CHECK((!points.images.at(0).moved && !points.images.at(1).moved));
    Mesh mesh;
    mesh.points = positions;
    const auto moved = carve_mesh(mesh, lattice, map).mesh;
    CHECK((moved.points[0] == positions[0] && moved.points[1] == positions[1]));
    CHECK(moved.points[2].x() == Approx(10.3 * (1 + by * (5.9 / 7) / 39)).margin(1e-3));
}

TEST_CASE("widths follow a ramp, to half a voxel at each height") {
    const auto lattice = make_box(Vec3d(0), {60, 9, 25}, 1.0, {0, 1, 2});
    const auto grid = grid_of({Coord(20, 0, 0), Coord(39, 8, 24)}, [](const Vec3d&) { return 1; });
    for (const double most : {-30.0, -12.5, 25.0}) {
        const auto out =
            carved_by_warp(grid, lattice, warped(lattice, ramp(lattice, most), Axis::u, {1}, 2));
        for (int k = 0; k < 25; ++k) {
            double width = 0;
            for (int x = -2; x < 100; ++x) width += out->tree().getValue({x, 4, k});
            CHECK(std::abs(width - 20 * (1 + most * std::max(0, k - 4) / 20.0 / 59)) < 0.5);
        }
    }
}

TEST_CASE(
    "a warp keeps the mass of a density within half a percent, in boxes, turned ones and rings") {
    const double by = GENERATE(-7.25, -12.0, 8.5);
    const std::array shape{48, 30, 28};
    const auto keeps = [&](const Lattice& lattice, const Seams& seams, const Vec3d& centre) {
        const auto grid = grid_of(CoordBBox::createCube(Coord::round(centre - Vec3d(16)), 32),
                                  [&](const Vec3d& at) {
                                      return std::exp(-(at - centre).lengthSqr() / 30) *
                                             (2 + std::sin(0.7 * at.x() + 0.3 * at.y()));
                                  });
        Volume volume;
        volume.grids = {grid};
        const auto map = map_of(lattice, {seams});
        const auto out = finished(volume, carve_volume(volume, lattice, map, Interpolation::linear),
                                  lattice, map, {std::nullopt, {"density"}, false});
        CHECK(sum(*out.grids[0].grid()) == Approx(sum(*grid)).epsilon(0.005));
        CHECK(std::abs(
                  sum(*carve_volume(volume, lattice, map, Interpolation::linear).grids[0].grid()) /
                      sum(*grid) -
                  1) > 0.02);
    };
    const auto straight = make_box(Vec3d(0), shape, 1.0, {0, 1, 2});
    keeps(straight, warped(straight, bump(straight, by)), Vec3d(23, 15, 14));
    keeps(straight, warped(straight, evenly(straight, by)), Vec3d(23, 15, 14));
    keeps(straight, warped(straight, ramp(straight, by), Axis::u, {1}, 4), Vec3d(23, 15, 18));
    const auto aslant = turned(make_box(Vec3d(-2, -2, 0), {56, 40, 28}, 1.0, {0, 1, 2}), 0.12);
    keeps(aslant, warped(aslant, bump(aslant, by)), Vec3d(24, 20, 14));
    const auto round = ring(Vec3d(0), {48, 30, 160}, 1.0, {0, -15});
    keeps(round, warped(round, evenly(round, by)), Vec3d(ring_radius(160, 1) + 22, 0, 0));
}

TEST_CASE("particles keep their density under a warp, where it squeezes and where it widens") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    const double by = GENERATE(-10.0, 9.5);
    const auto lattice = make_box(Vec3d(0), {40, 30, 30}, 1.0, {0, 1, 2});
    std::vector<Vec3d> positions;
    std::vector<std::uint64_t> ids;
    constexpr int count = 400000;
    for (int n = 0; n < count; ++n) {
        positions.push_back(Vec3d(unit(random), unit(random), unit(random)) * Vec3d(39, 29, 29));
        ids.push_back(static_cast<std::uint64_t>(n));
    }
    const auto out =
        carve_points(positions, ids, lattice, map_of(lattice, {warped(lattice, bump(lattice, by))}),
                     default_jitter);
    std::vector<double> slices(60, 0.0);
    for (const auto& image : out.images)
        ++slices[static_cast<std::size_t>(
            (image.moved ? image.position : positions[image.source]).x())];
    const double density = count / 39.0;
    // Three standard deviations of such a number, and what is asked for.
    for (std::size_t n = 1; n + 2 < static_cast<std::size_t>(39 + by); ++n)
        CHECK(slices[n] == Approx(density).epsilon(0.02 + 3 / std::sqrt(density)));
    CHECK(static_cast<double>(out.images.size()) == Approx(density * (39 + by)).epsilon(0.01));
}

TEST_CASE("no face of a mesh is turned over, however steep the warp") {
    const auto lattice = make_box(Vec3d(0), {40, 30, 4}, 1.0, {0, 1, 2});
    const auto steep = [](int entry, int lateral, int k, int) {
        const double begin = 8 + 4 * std::sin(0.4 * lateral) + k;
        return -0.9 * std::clamp(entry - begin, 0.0, 15.0);
    };
    const auto map = map_of(lattice, {warped(lattice, steep)});
    Mesh mesh;
    constexpr int edge = 100;
    for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x) mesh.points.push_back(Vec3d(0.39 * x, 0.29 * y, 1.5));
    const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(x + edge * y); };
    for (int y = 0; y + 1 < edge; ++y)
        for (int x = 0; x + 1 < edge; ++x)
            mesh.add_face(std::array{at(x, y), at(x + 1, y), at(x, y + 1)});
    const auto out = carve_mesh(mesh, lattice, map).mesh;
    double least = 1;
    for (std::size_t n = 0; n < out.faces(); ++n) {
        const auto face = out.face(n);
        const auto& p = out.points;
        least = std::min(
            least, (p[face[1]] - p[face[0]]).cross(p[face[2]] - p[face[0]]).z() / (0.39 * 0.29));
    }
    CHECK(least > 0.09);
    CHECK(least < 0.2);
}

TEST_CASE("a ring's warp does not know where the ring begins") {
    const int factor = GENERATE(1, 2);
    const auto lattice = ring(Vec3d(0), {12, 10, 60}, 1.0, {-5, -5});
    const double radius = ring_radius(60, 1);
    const auto grid = grid_of({Coord(-26, -26, -6), Coord(26, 26, 6)}, [&](const Vec3d& at) {
        return std::sin(0.5 * at.x()) + std::cos(0.4 * at.y()) * at.z() +
               0.1 * (at.length() - radius);
    });
    const auto wave = [](int entry, int lateral, int k, int) {
        return entry * (-0.2 - 0.1 * std::sin(2 * M_PI * k / 60) + 0.01 * lateral);
    };
    auto planes = lattice.planes;
    constexpr int shift = 14;
    std::rotate(planes.begin(), planes.begin() + shift, planes.end());
    const auto shifted = with_planes(lattice.shape, 1.0, true, planes, "shifted");
    const auto a = carved_by_warp(grid, lattice, warped(lattice, wave, Axis::u, {1}, factor)),
               b = carved_by_warp(grid, shifted,
                                  warped(
                                      shifted,
                                      [&](int entry, int lateral, int k, int t) {
                                          return wave(entry, lateral, k + shift, t);
                                      },
                                      Axis::u, {1}, factor));
    double most = 0, moved = 0;
    for (auto at = grid->evalActiveVoxelBoundingBox().begin(); at; ++at) {
        most = std::max(
            most, static_cast<double>(std::abs(a->tree().getValue(*at) - b->tree().getValue(*at))));
        moved = std::max(moved, static_cast<double>(std::abs(a->tree().getValue(*at) -
                                                             grid->tree().getValue(*at))));
    }
    CHECK(most < 1e-3);
    CHECK(moved > 0.5);
}

TEST_CASE(
    "whole numbers are carved by a warp, never mixed, and a window leaves what is beside it "
    "alone") {
    const auto lattice = make_box(Vec3d(0), {40, 6, 6}, 1.0, {0, 1, 2});
    const auto grid = openvdb::Int32Grid::create(0);
    for (auto at = CoordBBox(Coord(0), Coord(39, 5, 5)).begin(); at; ++at)
        grid->tree().setValueOn(*at, (*at).x() * 100);
    // What is taken from vertex 5 on is given back up to vertex 30.
    const auto pair = [](int entry, int, int, int) {
        return entry < 5 || entry > 30 ? 0 : -3.0 * std::sin(M_PI * (entry - 5) / 25);
    };
    const auto seams = warped(lattice, pair);
    CHECK(seams.shape_after(1) == lattice.shape);
    const auto out = openvdb::gridConstPtrCast<openvdb::Int32Grid>(
        carve_grid(grid, lattice, map_of(lattice, {seams}), Interpolation::linear));
    int changed = 0;
    for (int x = 0; x < 40; ++x) {
        const int value = out->tree().getValue({x, 3, 3});
        CHECK(value % 100 == 0);
        if (x <= 5 || x >= 30) CHECK(value == x * 100);
        changed += value != x * 100;
    }
    CHECK(changed > 10);
    CHECK(out->activeVoxelCount() == grid->activeVoxelCount());
}

TEST_CASE("a warp is the same by whole numbers and by sampling, and on one thread") {
    const auto lattice = make_box(Vec3d(0), {40, 20, 18}, 1.0, {0, 1, 2});
    const auto grid = grid_of({Coord(0), Coord(45, 19, 17)}, [](const Vec3d& at) {
        return std::sin(0.4 * at.x() + 0.2 * at.y()) + 0.1 * at.z();
    });
    const auto seams = warped(lattice, ramp(lattice, GENERATE(-8.5, 5.5)));
    const auto fast = carved_by_warp(grid, lattice, seams);
    const auto map = map_of(lattice, {seams});
    const auto sampled =
        carve_sampled<FloatGrid>(grid, Mapping(lattice, map.reach()), map, Interpolation::linear);
    int differ = 0;
    for (auto at = CoordBBox(Coord(0), Coord(50, 19, 17)).begin(); at; ++at) {
        differ += fast->tree().isValueOn(*at) != sampled->tree().isValueOn(*at);
        REQUIRE(fast->tree().getValue(*at) == Approx(sampled->tree().getValue(*at)).margin(1e-4));
    }
    CHECK(differ == 0);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(bytes(carved_by_warp(grid, lattice, seams)->baseTree()) == bytes(fast->baseTree()));
}

TEST_CASE("a fade takes a warp back to the identity at the rims") {
    const auto lattice = make_box(Vec3d(0), {40, 20, 18}, 1.0, {0, 1, 2});
    const auto grid =
        grid_of({Coord(-3), Coord(42, 22, 20)}, [](const Vec3d& at) { return at.x(); });
    auto map = map_of(lattice, {warped(lattice, evenly(lattice, -8))});
    map.fade_rims(6);
    const auto out =
        openvdb::gridConstPtrCast<FloatGrid>(carve_grid(grid, lattice, map, Interpolation::linear));
    CHECK(out->tree().getValue({20, 0, 9}) == 20);
    CHECK(out->tree().getValue({20, 3, 9}) ==
          Approx(20 + 0.5 * (20 * 39 / 31.0 - 20)).margin(1e-3));
    CHECK(out->tree().getValue({20, 9, 9}) == Approx(20 * 39 / 31.0).margin(1e-3));
}

TEST_CASE("content across a rim is told of a warp, at the end of each column too") {
    const auto lattice = make_box(Vec3d(0), {40, 20, 12}, 1.0, {0, 1, 2});
    const auto seams = warped(lattice, ramp(lattice, -8));
    const auto with = [&](const CoordBBox& box) {
        Volume out;
        out.grids = {grid_of(box, [](const Vec3d&) { return 1; })};
        return find_tears(out, lattice, map_of(lattice, {seams}));
    };
    CHECK(with({Coord(0), Coord(39, 19, 11)}).empty());
    const auto along_v = with({Coord(0, -4, 0), Coord(39, 10, 11)});
    REQUIRE(along_v.size() == 1);
    CHECK(along_v[0].rim == "v = 0");
    const auto at_end = with({Coord(30, 2, 0), Coord(45, 17, 11)});
    REQUIRE(at_end.size() == 1);
    CHECK(at_end[0].rim == "u = 39");
    CHECK(at_end[0].share > 0.3);
    // Where the ramp is 0 nothing can tear.
    CHECK(with({Coord(30, 2, 0), Coord(45, 17, 4)}).empty());
}

TEST_CASE(
    "nodes refuse what a warp can't do: a still source under a moving warp, a filter along seams") {
    const auto lattice = std::make_shared<Lattice>(make_box(Vec3d(0), {20, 5, 4}, 1.0, {0, 1, 2}));
    const auto volume = std::make_shared<Volume>();
    volume->grids = {grid_of({Coord(0), Coord(19, 4, 3)}, [](const Vec3d& at) { return at.x(); })};
    const auto run = [&](NodeType type, const Seams& seams, const Context& context) {
        return NodeBench(std::move(type))
            .run({{"source", {Payload(volume)}},
                  {"lattice", {Payload(lattice)}},
                  {"seams", {Payload(std::make_shared<Seams>(seams))}}},
                 context);
    };
    struct Silent : Context::Host {
        void warn(const std::string&) override {}
        void report(const std::string&, const nlohmann::ordered_json&) override {}
    } host;
    const std::vector<int> frames{1, 2};
    const auto moving = warped(
        *lattice, [](int entry, int, int, int t) { return -0.1 * entry * (t + 1); }, Axis::u,
        frames);
    const auto still = warped(*lattice, evenly(*lattice, -3), Axis::u, frames, 1, true);
    CHECK(failure_of([&] { run(remap_grids(), moving, Context(host, frames)); }) ==
          "the source is one file for all frames, but the warp changes from frame to frame; read "
          "it by a path with a frame token");
    CHECK(
        run(remap_grids(), still, Context(host, frames)).at("volume").as<Volume>()->grids.size() ==
        1);
    CHECK(failure_of([&] { run(filter_seam(), still, Context(host, frames).at(0)); }) ==
          "a warp is among the `seams`, but it leaves no seams to smooth along, since it is smooth "
          "everywhere; leave this node out");
}
