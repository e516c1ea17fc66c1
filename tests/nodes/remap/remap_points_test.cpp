#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "formats/points_file/points_file.h"
#include "nodes/remap.h"
#include "tests/nodes/remap/remap_points_cases.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"
#include "tests/support/reference_carve.h"
#include "tests/support/wavy_seams.h"

#include <tbb/task_arena.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::BBoxd;
using openvdb::Vec2d;
using openvdb::Vec3d;

namespace {

/// METHOD 6 to the letter, for a point between vertices: where it goes along the carved axis.
/// @param close  set if rounding may decide, or if both seams of a pair claim the point
std::vector<double> places_by_definition(const Seams& seams, const Vec3d& at, bool& close) {
    const double u = at[static_cast<int>(dimension(seams.axis))],
                 lateral = at[static_cast<int>(lateral_dimension(seams.axis))],
                 slice = at[static_cast<int>(slice_dimension(seams.axis))];
    const int j = static_cast<int>(lateral), k = static_cast<int>(slice);
    const double b = lateral - j, c = slice - k;
    // Per window, original entries sorted within each column, then bilinear between the columns.
    const auto between = [&](const std::vector<Seams::Seam>& window, Kind kind) {
        std::vector<double> out(window.size());
        for (int n = 0; n < 4; ++n) {
            const int column_j = std::min(j + (n & 1), seams.laterals() - 1),
                      column_k = (k + (n >> 1)) % seams.slices();
            std::vector<int> entries;
            for (const auto& seam : window)
                entries.push_back(
                    seam.at[static_cast<std::size_t>(column_j + seams.laterals() * column_k)]);
            if (kind == Kind::remove) {
                std::vector<int> left, original;
                for (int i = 0; i < seams.before(); ++i) left.push_back(i);
                for (const int entry : entries) {
                    original.push_back(left.at(static_cast<std::size_t>(entry)));
                    left.erase(left.begin() + entry);
                }
                entries = original;
            }
            std::ranges::sort(entries);
            for (std::size_t s = 0; s < out.size(); ++s)
                out[s] += (n & 1 ? b : 1 - b) * (n & 2 ? c : 1 - c) * entries[s];
        }
        return out;
    };
    double shift = 0;
    int copies = 0;
    bool gone = false;
    const auto take = [&](const std::vector<Seams::Seam>& window, Kind kind) {
        for (const double s : between(window, kind)) {
            const double off = kind == Kind::remove
                                   ? std::abs(u - s) - 0.5
                                   : std::min(std::abs(u - s), std::abs(u - s - 1));
            close = close || std::abs(off) < 2e-5;
            if (kind == Kind::remove) {
                gone = gone || std::abs(u - s) < 0.5;
                shift -= s < u;
            } else {
                shift += s + 1 <= u;
                copies += s < u && u < s + 1;
            }
        }
    };
    take(seams.seams, seams.kind);
    take(seams.pairs, opposite(seams.kind));
    close = close || (gone && copies > 0);
    if (gone) return {};
    std::vector<double> out;
    const int change = static_cast<int>(seams.seams.size()) * (seams.kind == Kind::remove ? -1 : 1);
    const double last = seams.before() - 1 + (seams.paired() ? 0 : change);
    for (int n = 0; n <= copies; ++n)
        if (u + shift + n >= 0 && u + shift + n <= last) out.push_back(u + shift + n);
    return out;
}

CarveStep step_of(const Seams& seams) { return {seams, 0, seams.seams.size()}; }

std::vector<double> places_of(const CarveStep& step, const Vec3d& at) {
    std::vector<double> out;
    std::vector<Vec2d> rooms;
    carve_point(step, at, out, rooms);
    for (std::size_t n = 1; n < out.size(); ++n) {
        CHECK(out[n] >= rooms[n][0]);
        CHECK(out[n] <= rooms[n][1]);
    }
    return out;
}

/// How many points there are in each slice between whole numbers of u; what was on the rim counts
/// below it.
std::map<int, int> counts_along_u(const CarvedPoints& carved, const std::vector<Vec3d>& positions) {
    std::map<int, int> out;
    for (const auto& image : carved.images)
        ++out[static_cast<int>(
            std::floor((image.moved ? image.position : positions[image.source]).x() - rim_slack))];
    return out;
}

}  // namespace

TEST_CASE(
    "a point goes where the definition says, for any seams that are removed, inserted or paired, "
    "along u, v and w") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto axis = GENERATE(Axis::u, Axis::v, Axis::w);
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const bool paired = GENERATE(false, true);
    const auto lattice = make_box(Vec3d(0), vertex_of(axis, 24, 6, 7), 1.0, {0, 1, 2});
    int gone = 0, several = 0;
    for (int round = 0; round < 30; ++round) {
        const auto seams = paired
                               ? random_pairs(random, lattice, lattice.shape, axis, kind, 5, {1})
                               : random_seams(random, lattice, lattice.shape, axis, kind, 6, {1});
        const auto step = step_of(seams);
        for (int n = 0; n < 200; ++n) {
            const auto at = Vec3d(unit(random), unit(random), unit(random)) *
                            Vec3d(lattice.shape[0] - 1, lattice.shape[1] - 1, lattice.shape[2] - 1);
            bool close = false;
            const auto got = places_of(step, at), wanted = places_by_definition(seams, at, close);
            if (close) continue;
            REQUIRE(got.size() == wanted.size());
            for (std::size_t p = 0; p < got.size(); ++p)
                REQUIRE(got[p] == Approx(wanted[p]).margin(1e-9));
            gone += got.empty();
            several += got.size() > 1;
        }
    }
    CHECK(gone > (kind == Kind::remove || paired ? 500 : -1));
    CHECK(several > (kind == Kind::insert || paired ? 500 : -1));
}

TEST_CASE(
    "of points right on vertices, or half a vertex beside them, a seam takes or doubles one "
    "layer") {
    const auto removed = step_of(straight_seams(points_box, Axis::u, Kind::remove, {10, 14}));
    const auto places = [&](const CarveStep& step, double u) {
        return places_of(step, Vec3d(u, 3, 4));
    };
    CHECK(places(removed, 9.5) == std::vector<double>{});
    CHECK(places(removed, 10) == std::vector<double>{});
    CHECK(places(removed, 10.5) == std::vector{9.5});
    CHECK(places(removed, 15) ==
          std::vector<double>{});  // the second seam, in the space that the first leaves
    CHECK(places(removed, 29) == std::vector{27.0});
    const auto inserted = step_of(straight_seams(points_box, Axis::u, Kind::insert, {10, 14}));
    CHECK(places(inserted, 10) == std::vector{10.0, 11.0});
    CHECK(places(inserted, 10.25) == std::vector{10.25, 11.25});
    CHECK(places(inserted, 11) == std::vector{12.0});
    CHECK(places(inserted, 14.5) == std::vector{15.5, 16.5});
    CHECK(places(inserted, 29) == std::vector{31.0});
}

TEST_CASE(
    "density stays wherever particles lie: on vertices, half a vertex beside them, and a rounding "
    "error off") {
    for (const double off : {0.0, 0.5, 1e-7, -1e-7, 0.5 + 1e-7, 0.5 - 1e-7, 0.25}) {
        std::vector<Vec3d> positions;
        for (int x = 0; x < 28; ++x)
            for (int y = 0; y < 8; ++y)
                for (int z = 0; z < 8; ++z) positions.emplace_back(x + 0.5 + off, y + 0.5, z + 0.5);
        for (const auto kind : {Kind::insert, Kind::remove}) {
            const auto seams = straight_seams(points_box, Axis::u, kind, {10, 14, 20});
            const auto carved = carve(positions, points_box, map_of(points_box, {seams}));
            std::map<long, int> layers;
            for (const auto& image : carved.images)
                ++layers[std::lround(
                    10 * ((image.moved ? image.position : positions[image.source]).x() - off))];
            INFO(off << " " << static_cast<int>(kind));
            CHECK(layers.size() == (kind == Kind::insert ? 31 : 25));
            for (const auto& [layer, count] : layers) CHECK(count == 64);
        }
    }
}

TEST_CASE(
    "where insertions extend the lattice they write over what was there, and beyond, nothing "
    "changes") {
    const auto inserted = step_of(straight_seams(points_box, Axis::u, Kind::insert, {3, 9, 12}));
    CHECK(places_of(inserted, Vec3d(29.01, 3, 4)).empty());
    CHECK(places_of(inserted, Vec3d(32, 3, 4)).empty());
    CHECK(places_of(inserted, Vec3d(32.01, 3, 4)) == std::vector{32.01});
    CHECK(places_of(inserted, Vec3d(31, 11.5, 4)) == std::vector{31.0});

    const std::vector<Vec3d> positions{Vec3d(29.5, 3, 4), Vec3d(31.9, 3, 4),    Vec3d(32.5, 3, 4),
                                       Vec3d(-0.1, 3, 4), Vec3d(29.5, -0.1, 4), Vec3d(29, 3, 13.1)};
    const auto carved =
        carve(positions, points_box,
              map_of(points_box, {straight_seams(points_box, Axis::u, Kind::insert, {3, 9, 12})}));
    CHECK(carved.deleted == 2);
    CHECK(carved.moved == 0);
    CHECK(carved.copied == 0);
    REQUIRE(carved.images.size() == 4);
    for (std::size_t n = 0; n < 4; ++n) {
        CHECK(carved.images[n].source == n + 2);
        CHECK_FALSE(carved.images[n].moved);
    }
}

TEST_CASE("the density of uniformly random points stays what it is, in seams and beside them") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const double per_cell = 150;
    // Beyond the lattice to the sides of u, so that nothing is special about its ends.
    const BBoxd around(Vec3d(-3, 0, 0), Vec3d(36, 11, 13));
    const auto positions = scattered(around, static_cast<std::size_t>(per_cell * 39 * 11 * 13), 5);
    const auto carved = carve(
        positions, points_box,
        map_of(points_box, {wavy_seams(points_box, Axis::u, kind, 13, 6, 2.0)}), default_jitter);
    const double slice = per_cell * 11 * 13;
    for (const auto& [u, count] : counts_along_u(carved, positions)) {
        INFO(u);
        if (u < -3) continue;
        if (kind == Kind::remove && u >= 23 && u < 29) CHECK(count == 0);
        else CHECK(std::abs(count - slice) < 5 * std::sqrt(2 * slice));
    }
    // Cell by cell where the seams run, which a pile would show.
    std::map<std::array<int, 3>, int> cells;
    for (const auto& image : carved.images) {
        const auto at =
            openvdb::Coord::floor(image.moved ? image.position : positions[image.source]);
        if (at.x() >= 6 && at.x() < 22) ++cells[{at.x(), at.y(), at.z()}];
    }
    CHECK(cells.size() == 16 * 11 * 13);
    double variance = 0;
    for (const auto& [at, count] : cells)
        variance += (count - per_cell) * (count - per_cell) / per_cell;
    variance /= static_cast<double>(cells.size());
    // Copies follow their originals, so that theirs is no second draw: between one and two.
    CHECK(variance > 0.85);
    CHECK(variance < 2.2);
}

TEST_CASE("a fade takes away and adds evenly less towards the rims, and keeps the density") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const double per_cell = 100;
    const auto lattice = make_box(Vec3d(0), {30, 21, 21}, 1.0, {0, 1, 2});
    const auto positions = scattered(BBoxd(Vec3d(-2, 0, 0), Vec3d(36, 20, 20)),
                                     static_cast<std::size_t>(per_cell * 38 * 20 * 20), 6);
    auto map =
        map_of(lattice, {straight_seams(lattice, Axis::u, kind,
                                        kind == Kind::remove ? std::vector{12, 12, 12, 12}
                                                             : std::vector{12, 13, 14, 15})});
    map.fade_rims(8);
    const auto carved = carve(positions, lattice, map);
    std::map<std::array<int, 2>, int>
        cells;  // by v and u, over w in the middle, where only v fades
    for (const auto& image : carved.images) {
        const auto at =
            openvdb::Coord::floor(image.moved ? image.position : positions[image.source]);
        if (at.z() >= 8 && at.z() < 12) ++cells[{at.y(), at.x()}];
    }
    for (int v = 0; v < 20; ++v)
        for (int u = 0; u < 24; ++u) {
            INFO(v << ' ' << u);
            CHECK(std::abs(cells[{v, u}] - 4 * per_cell) < 6 * std::sqrt(2 * 4 * per_cell));
        }
    // At the rim nothing is lost or added; in the middle four entries are.
    const auto kept = [&](double low, double high) {
        int before = 0, after = 0;
        const auto in = [&](const Vec3d& at) {
            return at.y() >= low && at.y() < high && at.z() >= 8 && at.z() < 12;
        };
        for (const auto& at : positions) before += in(at) && at.x() >= 0 && at.x() < 29;
        for (const auto& image : carved.images)
            after += in(positions[image.source]) && positions[image.source].x() >= 0 &&
                     positions[image.source].x() < 29;
        return static_cast<double>(after) / before;
    };
    const double whole = kind == Kind::remove ? 25 / 29.0 : 33 / 29.0;
    CHECK(kept(0, 0.4) == Approx(1).margin(0.02));
    CHECK(kept(3.5, 4.5) == Approx((1 + whole) / 2).margin(0.02));
    CHECK(kept(9, 11) == Approx(whole).margin(0.02));
}

TEST_CASE("right beside a rim a fading seam takes and adds no less than its width") {
    for (const double width : {1e-7, 4e-6, 1e-5, 4e-5, 1e-3}) {
        INFO(width);
        const auto places = [&](Kind kind, double from_bound) {
            auto step = step_of(straight_seams(points_box, Axis::u, kind, {10}));
            step.fade_rims(4);
            // An inserted seam doubles what is right before its new entry.
            const double bound = kind == Kind::remove ? 9.5 : 11 - width;
            auto out = places_of(step, Vec3d(bound + from_bound * width, 4 * width, 6));
            for (auto& place : out) place = (place - bound) / width;
            return out;
        };
        const auto are = [](const std::vector<double>& got, const std::vector<double>& wanted) {
            REQUIRE(got.size() == wanted.size());
            for (std::size_t n = 0; n < got.size(); ++n)
                CHECK(got[n] == Approx(wanted[n]).margin(1e-6));
        };
        are(places(Kind::remove, -0.5), {-0.5});
        are(places(Kind::remove, 0.5), {});
        are(places(Kind::remove, 1.5), {0.5});
        are(places(Kind::insert, -0.5), {-0.5});
        are(places(Kind::insert, 0.5), {0.5, 1.5});
        are(places(Kind::insert, 1.5), {2.5});
    }
}

TEST_CASE(
    "in bent and closed lattices points outside stay, and the others move by whole vertices along "
    "u") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    std::mt19937 random(11);
    for (const auto& lattice : {ring(Vec3d(0.3, 0.2, 0.1), {20, 9, 120}, 0.25, Vec2d(-2, -1)),
                                helix({16, 9, 90}, 0.3, 6, 1)}) {
        const auto seams = wavy_seams(lattice, Axis::u, kind, 8, 3, 1.5);
        const auto map = map_of(lattice, {seams});
        const Mapping mapping(lattice, map.reach()), own(lattice);
        auto around = mapping.world_box(BBoxd(Vec3d(-3), Vec3d(24, 12, lattice.shape[2])));
        const auto positions = scattered(around, 60000, 12);
        const auto carved = carve(positions, lattice, map);
        std::map<std::uint32_t, std::vector<Vec3d>> results;
        for (const auto& image : carved.images)
            results[image.source].push_back(image.moved ? image.position : positions[image.source]);
        int outside = 0, moved = 0, copied = 0, closing = 0;
        for (std::uint32_t n = 0; n < positions.size(); ++n) {
            const auto from = own.locate(positions[n]);
            if (!from) {
                if (mapping.locate(positions[n])) continue;
                ++outside;
                REQUIRE(results[n] == std::vector{positions[n]});
                continue;
            }
            bool close = false;
            const auto wanted = places_by_definition(seams, *from, close);
            if (close) continue;
            REQUIRE(results[n].size() == wanted.size());
            for (std::size_t p = 0; p < wanted.size(); ++p) {
                const auto to = positions[n] +
                                mapping.position(Vec3d(wanted[p], from->y(), from->z())) -
                                mapping.position(*from);
                REQUIRE((results[n][p] - to).length() < 1e-9);
                if (wanted[p] == from->x()) REQUIRE(results[n][p] == positions[n]);
                ++(p == 0 ? moved : copied);
            }
            closing += from->z() > lattice.shape[2] - 1;
        }
        CHECK(outside > 10000);
        CHECK(moved > 2000);
        CHECK((copied > 500) == (kind == Kind::insert));
        CHECK((closing > 20) == lattice.closed);
    }
}

TEST_CASE("a chain is carved in its order, each step in the space that those before it leave") {
    std::mt19937 random(13);
    const auto first =
        random_seams(random, points_box, points_box.shape, Axis::u, Kind::remove, 5, {1});
    const auto second =
        random_seams(random, points_box, first.shape_after(5), Axis::v, Kind::insert, 3, {1});
    const auto third =
        random_pairs(random, points_box, second.shape_after(3), Axis::u, Kind::insert, 4, {1});
    const auto positions = scattered(BBoxd(Vec3d(0), Vec3d(29, 11, 13)), 20000, 14);
    const auto carved = carve(positions, points_box, map_of(points_box, {first, second, third}));
    std::map<std::uint32_t, std::vector<Vec3d>> results;
    for (const auto& image : carved.images)
        results[image.source].push_back(image.moved ? image.position : positions[image.source]);
    for (std::uint32_t n = 0; n < positions.size(); ++n) {
        std::vector<Vec3d> wanted{positions[n]};
        bool close = false;
        for (const auto* const seams : {&first, &second, &third}) {
            std::vector<Vec3d> next;
            for (const auto& at : wanted)
                for (const double place : places_by_definition(*seams, at, close)) {
                    next.push_back(at);
                    next.back()[static_cast<int>(seams->axis)] = place;
                }
            wanted = next;
        }
        if (close) continue;
        REQUIRE(results[n].size() == wanted.size());
        for (std::size_t p = 0; p < wanted.size(); ++p)
            REQUIRE((results[n][p] - wanted[p]).length() < 1e-9);
    }
    CHECK(carved.copied > 1000);
    CHECK(carved.deleted > 1000);
    // Also where a step takes a point whose copy stays.
    CHECK(carved.images.size() == positions.size() - carved.deleted + carved.copied);
}
