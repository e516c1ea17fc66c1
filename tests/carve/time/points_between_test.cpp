#include "carve/time/points_between.h"

#include "carve/points/point_vectors.h"
#include "carve/time/between.h"
#include "carve/time/thumbnails.h"
#include "tests/support/point_lists.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

/// Points with a velocity as `v`, in a PLY table.
Points flowing(const std::vector<Vec3d>& at, const std::vector<Vec3d>& velocities, int first_id = 0,
               bool with_ids = true) {
    auto table = ply_at(at);
    if (with_ids)
        for (std::size_t n = 0; n < at.size(); ++n)
            PointTable::set(table.columns.back(), n, static_cast<double>(first_id) + double(n));
    else table.columns.pop_back();
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float> values;
        for (const auto& each : velocities) values.push_back(static_cast<float>(each[axis]));
        table.columns.push_back(
            column(std::string("v_") + "xyz"[axis], "float", NumberType::float32, values));
    }
    Points out;
    out.ply = std::make_shared<PointTable>(std::move(table));
    return out;
}

/// Points on circles around z, after a turn by so many radians; velocities per 4 radians.
Points turned(double angle, bool with_ids = true) {
    std::vector<Vec3d> at, velocities;
    for (const auto& start : scattered(openvdb::BBoxd(Vec3d(-3), Vec3d(3)), 4000, 7)) {
        const double cos = std::cos(angle), sin = std::sin(angle);
        at.emplace_back(cos * start.x() - sin * start.y(), sin * start.x() + cos * start.y(),
                        start.z());
        velocities.push_back(4.0 * Vec3d(-at.back().y(), at.back().x(), 0));
    }
    return flowing(at, velocities, 0, with_ids);
}

std::map<std::uint64_t, Vec3d> by_id(const Points& points, const std::vector<Vec3d>& values) {
    std::map<std::uint64_t, Vec3d> out;
    const auto ids = points.identities();
    for (std::size_t n = 0; n < ids.size(); ++n) out[ids[n]] = values[n];
    return out;
}
std::map<std::uint64_t, Vec3d> places(const Points& points) {
    return by_id(points, points.positions());
}

/// Greatest distance of points of the same id.
double farthest(const Points& a, const Points& b) {
    const auto there = places(b);
    double out = 0;
    for (const auto& [id, at] : places(a)) out = std::max(out, (at - there.at(id)).length());
    return out;
}

}  // namespace

TEST_CASE("points with ids and velocities keep to their circles, where straight ways cut them") {
    const auto kind = GENERATE(as<bool>{}, false, true);
    constexpr double turn = 0.6;
    auto a = turned(0), b = turned(turn);
    if (kind) a = in_vdb(a), b = in_vdb(b);
    CHECK(velocity_name(a) == "v");
    const double scale = point_scale(a, b, "v");
    CHECK(scale == Approx(turn / 4).epsilon(0.05));
    for (const double share : {0.25, 0.5, 0.8}) {
        const auto between = points_between(a, b, share, {"v", scale});
        CHECK(between.size() == 4000);
        const auto true_ones = turned(share * turn);
        CHECK(farthest(between, true_ones) < 0.008);
        CHECK(farthest(points_between(a, b, share, {"", 0}), true_ones) > 0.05);
        const auto velocities = by_id(between, vectors_of(between, "v")),
                   true_velocities = by_id(true_ones, vectors_of(true_ones, "v"));
        for (const auto& [id, velocity] : velocities)
            REQUIRE((velocity - true_velocities.at(id)).length() < 0.9);
    }
}

TEST_CASE("points that only one frame has come and go one by one, on their way") {
    const auto box = openvdb::BBoxd(Vec3d(0), Vec3d(1));
    const std::vector<Vec3d> up(1000, Vec3d(0, 0, 2));
    const auto a = flowing(scattered(box, 1000, 1), up, 0),
               b = flowing(scattered(box, 1000, 2), up, 500);
    const PointMotion motion{"v", 0.5};
    const auto old = places(a), next = places(b);
    std::size_t left = 500, come = 0;
    for (const double share : {0.1, 0.4, 0.5, 0.9}) {
        std::size_t leaving = 0, coming = 0;
        for (const auto& [id, at] : places(points_between(a, b, share, motion))) {
            if (id < 500) {
                ++leaving;
                CHECK((at - old.at(id) - Vec3d(0, 0, share)).length() < 1e-9);
            }
            if (id >= 1000) {
                ++coming;
                CHECK((at - next.at(id) + Vec3d(0, 0, 1 - share)).length() < 1e-9);
            }
        }
        CHECK(leaving == Approx(500 * (1 - share)).margin(50));
        CHECK(coming == Approx(500 * share).margin(50));
        CHECK(leaving <= left);
        CHECK(coming >= come);
        left = leaving;
        come = coming;
    }
}

TEST_CASE("without ids, points of the nearer frame move along velocities whose scale is found") {
    const auto a = turned(0, false), b = turned(0.05, false);
    CHECK(!a.has_ids());
    const double scale = point_scale(a, b, "v");
    CHECK(scale == Approx(0.05 / 4).epsilon(0.02));
    const auto early = points_between(a, b, 0.3, {"v", scale}).positions(),
               late = points_between(a, b, 0.7, {"v", scale}).positions(),
               true_early = turned(0.015).positions(), true_late = turned(0.035).positions();
    REQUIRE(early.size() == 4000);
    for (std::size_t n = 0; n < early.size(); ++n) {
        REQUIRE((early[n] - true_early[n]).length() < 0.002);
        REQUIRE((late[n] - true_late[n]).length() < 0.002);
    }
}

TEST_CASE("a velocity that is not finite moves nothing") {
    const double nan = std::nan("");
    const auto a = flowing({Vec3d(0), Vec3d(1)}, {Vec3d(nan), Vec3d(2)}),
               b = flowing({Vec3d(1), Vec3d(2)}, {Vec3d(nan), Vec3d(2)});
    CHECK(point_scale(a, b, "v") == Approx(0.5));
    const auto at = places(points_between(a, b, 0.25, {"v", 0.5}));
    CHECK((at.at(0) - Vec3d(0.25)).length() < 1e-9);
    CHECK((at.at(1) - Vec3d(1.25)).length() < 1e-9);
}

TEST_CASE("where one frame goes over into another, each point is shown once, by its id") {
    const auto box = openvdb::BBoxd(Vec3d(0), Vec3d(1));
    const std::vector<Vec3d> still(2000, Vec3d(0));
    const auto at = scattered(box, 2000, 1);
    auto moved = at;
    for (auto& each : moved) each += Vec3d(0.2, 0.25, 0);
    for (const bool vdb : {false, true}) {
        auto a = flowing(at, still), b = flowing(moved, still);
        if (vdb) a = in_vdb(a), b = in_vdb(b);
        // From the first to the second along x.
        const auto share = [](const Vec3d& world) {
            return std::clamp(3 * world.x() - 1, 0.0, 1.0);
        };
        const auto mixed = places(points_mixed(a, b, share, a));
        const auto old = places(a), now = places(b);
        REQUIRE(mixed.size() == 2000);
        std::size_t second = 0, between = 0;
        for (const auto& [id, place] : mixed) {
            const bool of_b = place.y() - old.at(id).y() > 0.1;
            REQUIRE((place - (of_b ? now : old).at(id)).length() < 1e-6);
            const double there = share(old.at(id));
            if (there == 0) REQUIRE_FALSE(of_b);
            else if (there == 1) REQUIRE(of_b);
            else {
                ++between;
                second += of_b;
            }
        }
        CHECK(static_cast<double>(second) == Approx(0.5 * static_cast<double>(between)).margin(40));
        // One side alone keeps its bits.
        CHECK(points_mixed(
                  a, b, [](const Vec3d&) { return 1.0; }, a)
                  .grid == b.grid);
        CHECK(points_mixed(
                  a, b, [](const Vec3d&) { return 0.0; }, b)
                  .ply == a.ply);
    }
    const auto other = points_at(at);
    CHECK(points_mixed(
              flowing(at, still), other, [](const Vec3d&) { return 0.5; }, other)
              .ply == other.ply);
}

TEST_CASE("the points of a volume go along in time as others do, and their velocities with it") {
    const auto a = in_vdb(turned(0)), b = in_vdb(turned(0.6));
    const auto held = [](const Points& points) {
        Volume out;
        out.grids.push_back(points.grid);
        return out;
    };
    const auto points_of = [](const Volume& volume) {
        Points out;
        out.grid = volume.grids.at(0).grid();
        return out;
    };
    const auto between =
        points_of(volume_between(held(a), held(b), 0.3, nullptr, Transport::semi_lagrangian));
    CHECK(farthest(between, points_between(a, b, 0.3, {"v", point_scale(a, b, "v")})) == 0);
    CHECK(farthest(between, turned(0.18)) < 0.008);
    const auto half = [](const Vec3d&) { return 0.5; };
    CHECK(places(points_of(volume_mixed(held(a), held(b), half, held(a)))) ==
          places(points_mixed(a, b, half, a)));
    const auto slower = vectors_of(points_of(velocities_scaled(held(a), "", 0.5)), "v");
    const auto as_fast = vectors_of(a, "v");
    for (std::size_t n = 0; n < slower.size(); ++n)
        REQUIRE((slower[n] - 0.5 * as_fast[n]).length() < 1e-6);
}

TEST_CASE("frames of points differ by how many lie where, and by where they move to") {
    const auto held = [](const Points& points) {
        Volume out;
        out.grids.push_back(in_vdb(points).grid);
        return out;
    };
    Thumbnails all;
    for (const double angle : {0.0, 0.1, 0.2, 0.0}) all.add(held(turned(angle)), nullptr);
    CHECK(all.difference(0, 3) < 1e-6);
    CHECK(all.difference(0, 1) > 0.3);
    CHECK(all.difference(0, 2) > 1.2 * all.difference(0, 1));
}

TEST_CASE("points of other attributes are those of the nearer frame alone") {
    const auto a = flowing({Vec3d(0)}, {Vec3d(1)}), b = points_at({Vec3d(1), Vec3d(2)});
    CHECK(!alike(a, b));
    CHECK(points_between(a, b, 0.4, {"v", 0}).size() == 1);
    const auto late = points_between(a, b, 0.6, {"v", 0});
    CHECK(late.positions() == b.positions());
    CHECK(alike(late, b));
}

TEST_CASE("a frame without points meets one with points") {
    const auto none = flowing({}, {}), some = flowing({Vec3d(0), Vec3d(1)}, {Vec3d(0), Vec3d(0)});
    CHECK(points_between(none, some, 0.999, {"v", 1}).size() == 2);
    CHECK(points_between(some, none, 0.999, {"v", 1}).size() == 0);
    CHECK(points_between(in_vdb(some), in_vdb(none), 0.001, {"v", 1}).size() == 2);
    CHECK(point_scale(none, some, "v") == 0);
}

TEST_CASE("other vectors leave all else of points as it is") {
    const auto points = in_vdb(turned(0));
    auto vectors = vectors_of(points, "v");
    for (auto& each : vectors) each *= -2;
    const auto out = with_vectors(points, "v", vectors);
    CHECK(out.positions() == points.positions());
    CHECK(out.identities() == points.identities());
    CHECK(vectors_of(out, "v") == vectors);
    CHECK(vectors_of(points, "v") != vectors);
    CHECK(vectors_of(points, "w").empty());
}
