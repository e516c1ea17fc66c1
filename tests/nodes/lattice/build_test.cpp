#include "carve/lattice/build.h"
#include "carve/base/failure.h"
#include "carve/rig/circle.h"
#include "nodes/lattice.h"
#include "tests/support/built_lattices.h"
#include "tests/support/node_bench.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

/// Where the rig meets plane k.
Vec3d origin(const Lattice& lattice, const LatticeSpec& spec, std::size_t k) {
    const auto& plane = lattice.planes[k];
    return plane.origin - spec.u[0] * plane.u - spec.v[0] * plane.v;
}

void require_orthonormal(const Lattice& lattice, double hand = 1) {
    for (const auto& plane : lattice.planes) {
        REQUIRE(std::abs(plane.u.length() - 1) < 1e-12);
        REQUIRE(std::abs(plane.v.length() - 1) < 1e-12);
        REQUIRE(std::abs(plane.w.length() - 1) < 1e-12);
        REQUIRE((plane.u - hand * plane.v.cross(plane.w)).length() < 1e-12);
        REQUIRE(std::abs(plane.v.dot(plane.w)) < 1e-12);
    }
}

/// How much a plane's basis turns about its path on the way to the next: the angle of `v`, next to
/// what the least rotation that takes `w` to the next `w` makes of it.
double twist(const Lattice::Plane& from, const Lattice::Plane& to) {
    const auto axis = from.w.cross(to.w);
    auto v = from.v;
    if (axis.length() > 1e-14) {
        const auto a = axis.unit();
        const double angle = std::atan2(axis.length(), from.w.dot(to.w));
        v = std::cos(angle) * v + std::sin(angle) * a.cross(v) +
            (1 - std::cos(angle)) * a.dot(v) * a;
    }
    return std::atan2(v.cross(to.v).dot(to.w), v.dot(to.v));
}

}  // namespace

TEST_CASE("a lattice along a straight rig is a box") {
    const auto built = build_lattice(through({{0, 3, 0}, {0, 3, 1.3}, {0, 3, 4}}, false, {0, 1, 0}),
                                     spec(0.1, {-1, 1}, {-0.4, 0.8}));
    const auto& lattice = built.lattice;
    // v is up, w the path, u = v x w.
    const auto box = make_box(Vec3d(-1, 2.6, 0), {21, 13, 41}, 0.1, {0, 1, 2});
    CHECK(lattice.shape == box.shape);
    CHECK(lattice.is_box());
    CHECK(built.step == 0.1);
    CHECK(built.folds.cells == 0);
    for (const auto& at : {Vec3d(0, 0, 0), Vec3d(20, 12, 40), Vec3d(3.5, 2.25, 17.75)})
        CHECK((lattice.position(at) - box.position(at)).length() < 1e-9);
    CHECK(lattice.description ==
          "lattice of 21 x 13 x 41 vertices along an open path of 3 points from (0, 3, 0) to (0, "
          "3, 4), u from -1, v from -0.4, spacing 0.1");
    CHECK(lattice.hash == lattice_hash(lattice));
}

TEST_CASE("a straight rig far out, askew and finely divided is still a box") {
    const auto turn = Vec3d(std::cos(0.12), std::sin(0.12), 0.05).unit();
    const auto built = build_lattice(
        through({Vec3d(130, -77, 41), Vec3d(130, -77, 41) + 20.0 * turn}), spec(0.01));
    CHECK(built.lattice.shape == std::array{101, 101, 2001});
    CHECK(built.lattice.is_box());
}

TEST_CASE("a spacing typed with few digits does not cost the last plane or vertex") {
    CHECK(build_lattice(through({{0, 0, 0}, {0, 9, 0}}), spec(0.333334, {0, 2}, {0, 1}))
              .lattice.shape == std::array{7, 4, 28});
    CHECK(build_lattice(through({{0, 0, 0}, {0, 9.2, 0}}), spec(1, {0, 2.9}, {0, 0.5}))
              .lattice.shape == std::array{3, 1, 10});
}

TEST_CASE("planes of a circle stand radially at equal distances, also where it closes") {
    const double radius = 5;
    const Vec3d center(1, 2, 3);
    const auto settings = spec(0.1, {-0.8, 0.8}, {-0.4, 0.4});
    const auto built = build_lattice(circle_rig(center, {0, 0, 1}, {radius, radius}, 0), settings);
    const auto& lattice = built.lattice;
    CHECK(lattice.shape == std::array{17, 9, 314});
    CHECK(lattice.closed);
    CHECK(!lattice.is_box());
    CHECK(built.step == Approx(2 * radius * std::sin(M_PI / 314)).epsilon(1e-13));
    require_orthonormal(lattice);
    double turned = 0, along = 0, uneven = 0;
    for (std::size_t k = 0; k < 314; ++k) {
        const auto& plane = lattice.planes[k];
        const auto out = (origin(lattice, settings, k) - center) / radius;
        turned = std::max({turned, (plane.u - out).length(), (plane.v - Vec3d(0, 0, 1)).length()});
        along = std::max(along, std::abs(out.length() - 1));
        uneven = std::max(
            uneven,
            std::abs(
                (origin(lattice, settings, (k + 1) % 314) - origin(lattice, settings, k)).length() -
                built.step));
    }
    CHECK(turned < 1e-12);
    CHECK(along < 1e-12);
    CHECK(uneven < 1e-12);
    // Clockwise from x: towards minus y.
    CHECK(lattice.planes[0].w.dot(Vec3d(0, -1, 0)) == Approx(1).epsilon(1e-12));
    CHECK((lattice.position(Vec3d(16, 4, 0)) - Vec3d(6.8, 2, 3)).length() < 1e-12);
}

TEST_CASE("planes of an oval stand at equal distances, also where it closes") {
    const auto settings = spec(0.1);
    const auto built = build_lattice(circle_rig({0, 0, 0}, {0, 1, 0}, {4, 1.5}, 0.3), settings);
    const auto count = built.lattice.planes.size();
    for (std::size_t k = 0; k < count; ++k) {
        const auto here = origin(built.lattice, settings, k),
                   next = origin(built.lattice, settings, (k + 1) % count);
        REQUIRE(std::abs((next - here).length() - built.step) < 1e-12);
        REQUIRE(std::abs(here.x() * here.x() / 16 + here.z() * here.z() / 2.25 - 1) < 1e-12);
        REQUIRE(here.dot(built.lattice.planes[k].u) > 0);
    }
    CHECK(std::abs(built.step / 0.1 - 1) < 0.5 / static_cast<double>(count));
}

TEST_CASE("a polyline is resampled by straight distances, corners or not") {
    const auto settings = spec(0.3, {-0.1, 0.1}, {-0.1, 0.1});
    auto options = settings;
    options.smooth = Smooth::none;
    const auto open =
        build_lattice(through({{0, 0, 0}, {1, 0, 0}, {1, 0.7, 0}, {2, 2, 1}}), options);
    for (std::size_t k = 0; k + 1 < open.lattice.planes.size(); ++k)
        REQUIRE(
            (origin(open.lattice, settings, k + 1) - origin(open.lattice, settings, k)).length() ==
            Approx(0.3).epsilon(1e-12));
    const auto closed =
        build_lattice(through({{0, 0, 0}, {5, 0, 0}, {5, 3, 0}, {0, 3, 0}}, true), options);
    const auto count = closed.lattice.planes.size();
    CHECK(count == 52);
    for (std::size_t k = 0; k < count; ++k)
        REQUIRE((origin(closed.lattice, settings, (k + 1) % count) -
                 origin(closed.lattice, settings, k))
                    .length() == Approx(closed.step).epsilon(1e-9));
    // Counter-clockwise seen from up: u points inwards.
    CHECK(closed.lattice.planes[8].u.dot(Vec3d(0, 1, 0)) > 0.99);
}

TEST_CASE("a basis carried along a helix is orthonormal and does not twist") {
    const auto built = build_lattice(through(helix_points()), spec(0.05, {-0.2, 0.2}, {-0.2, 0.2}));
    require_orthonormal(built.lattice);
    double worst = 0, total = 0;
    for (std::size_t k = 0; k + 1 < built.lattice.planes.size(); ++k) {
        const double angle = twist(built.lattice.planes[k], built.lattice.planes[k + 1]);
        worst = std::max(worst, std::abs(angle));
        total += std::abs(angle);
    }
    CHECK(worst < 1e-5);
    CHECK(total < 2e-3);
}

TEST_CASE("what a closed rig turns a basis by is spread evenly over all planes") {
    const auto built =
        build_lattice(through(saddle_points(), true), spec(0.05, {-0.2, 0.2}, {-0.2, 0.2}));
    require_orthonormal(built.lattice);
    const auto& planes = built.lattice.planes;
    double least = 1e9, most = -1e9, sum = 0;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        const double angle = twist(planes[k], planes[(k + 1) % planes.size()]);
        least = std::min(least, angle);
        most = std::max(most, angle);
        sum += angle;
    }
    CHECK(std::abs(sum) > 0.01);
    CHECK(most - least < 1e-4);
    CHECK(std::abs(most - sum / static_cast<double>(planes.size())) < 1e-4);
}

TEST_CASE("flip_u mirrors a lattice") {
    auto settings = spec(0.1, {-0.3, 0.8});
    const auto circle = circle_rig({0, 0, 0}, {0, 0, 1}, {3, 3}, 0);
    const auto plain = build_lattice(circle, settings);
    settings.flip_u = true;
    const auto flipped = build_lattice(circle, settings);
    require_orthonormal(flipped.lattice, -1);
    CHECK((plain.lattice.position(Vec3d(0, 5, 0)) - Vec3d(2.7, 0, 0)).length() < 1e-12);
    CHECK((flipped.lattice.position(Vec3d(0, 5, 0)) - Vec3d(3.3, 0, 0)).length() < 1e-12);
    CHECK((flipped.lattice.position(Vec3d(11, 5, 0)) - Vec3d(2.2, 0, 0)).length() < 1e-12);
    CHECK(plain.lattice.hash != flipped.lattice.hash);
}

TEST_CASE("the closed form has the paper's directions, each towards the next plane") {
    auto settings = spec(0.1);
    settings.closed_form = true;
    const auto lattice =
        build_lattice(circle_rig({0, 0, 0}, {0, 0, 1}, {5, 5}, 0), settings).lattice;
    CHECK(lattice.closed_form);
    const auto count = lattice.planes.size();
    for (const std::size_t k : {std::size_t{0}, std::size_t{7}, count - 1})
        CHECK((origin(lattice, settings, (k + 1) % count) - origin(lattice, settings, k))
                  .unit()
                  .dot(lattice.planes[k].w) == Approx(1).epsilon(1e-12));
    auto other = lattice;
    other.closed_form = false;
    CHECK(lattice_hash(other) != lattice.hash);
    other = lattice;
    other.closed = false;
    CHECK(lattice_hash(other) != lattice.hash);
}

TEST_CASE("positions go around a closed lattice") {
    const auto lattice =
        build_lattice(circle_rig({0, 0, 0}, {0, 0, 1}, {5, 5}, 0), spec(0.1)).lattice;
    const double around = lattice.shape[2];
    for (const double w : {0.0, 0.5, around - 0.5, around - 1}) {
        CHECK((lattice.position({3, 4, w}) - lattice.position({3, 4, w + around})).length() < 1e-9);
        CHECK((lattice.position({3, 4, w}) - lattice.position({3, 4, w - around})).length() < 1e-9);
    }
    CHECK((lattice.position({3, 4, around - 0.5}) -
           0.5 * (lattice.position({3, 4, around - 1}) + lattice.position({3, 4, 0})))
              .length() < 1e-12);
    CHECK(lattice.position({3, 4, around - 0.25}).y() ==
          Approx(-lattice.position({3, 4, 0.25}).y()).margin(1e-12));
}

TEST_CASE("folded cells are those in which neighbouring planes cross") {
    // Planes that turn about a point at distance 1: cells inside of it are folded.
    auto settings = spec(0.1, {-1.55, 0.5}, {0, 0.25});
    settings.smooth = Smooth::none;
    const auto lattice =
        build_lattice(circle_rig({0, 0, 0}, {0, 0, 1}, {1, 1}, 0), settings).lattice;
    const auto folds = count_folds(lattice, lattice.shape[0], lattice.shape[1]);
    const auto planes = static_cast<std::size_t>(lattice.shape[2]);
    // Vertices at -1.55, ..., -1.05 lie beyond the centre: the six cells that begin there, in both
    // rows.
    CHECK(folds.cells == 6 * 2 * planes);
    CHECK(folds.in_plane == 12);
    CHECK(folds.plane == 0);
    CHECK(count_folds(lattice, lattice.shape[0], 1).cells == 6 * planes);
    CHECK(count_folds(make_box(Vec3d(0), {4, 4, 4}, 1, {0, 1, 2}), 40, 40).cells == 0);
}

TEST_CASE("smoothing takes the folds out of a kinked rig") {
    const auto kinked = through({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}});
    auto settings = spec(0.1);
    CHECK(build_lattice(kinked, settings).folds.cells > 0);
    for (const auto smooth : {Smooth::points, Smooth::directions}) {
        settings.smooth = smooth;
        settings.max_iterations = 1000;
        const auto built = build_lattice(kinked, settings);
        CHECK(built.folds.cells == 0);
        CHECK(built.iterations > 5);
        CHECK(built.iterations < 1000);
        require_orthonormal(built.lattice);
        CHECK((built.moved > 0) == (smooth == Smooth::points));
        CHECK(built.moved < 0.5);
        CHECK((origin(built.lattice, settings, 0) - Vec3d(0)).length() < 1e-12);
        CHECK((origin(built.lattice, settings, built.lattice.planes.size() - 1) - Vec3d(4, 4, 0))
                  .length() < 0.1);
    }
    settings.smooth = Smooth::none;
    CHECK(build_lattice(kinked, settings).iterations == 0);
}

TEST_CASE("a rig that can't carry a lattice is refused") {
    const auto fault = [](const Rig& rig, double spacing,
                          std::optional<int> planes = std::nullopt) {
        return failure_of([&] { build_lattice(rig, spec(spacing), planes); });
    };
    CHECK(fault(through({{1, 1, 1}}), 1) == "a rig needs at least 2 points, not 1");
    CHECK(fault(through({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}), 0.1) ==
          "points 2 and 3 of the rig are the same, (1, 0, 0)");
    CHECK(fault(through({{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}), 0.1) ==
          "the rig turns right back at point 2, (1, 0, 0)");
    CHECK(fault(through({{0, 0, 0}, {0.5, 0, 0}}), 1) ==
          "the rig, 0.5 long, stays within one spacing, 1, of its start; take a smaller spacing");
    CHECK(fault(through({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, true), 2) ==
          "the closed rig is 3.41421 around; at a spacing of 2 that makes fewer than three planes");
    CHECK(fault(through({{0, 0, 0}, {0, 0, 5}}), 1) ==
          "the rig starts along its 'up', (0, 0, 1), which leaves the direction of v open; state "
          "another 'up'");
    CHECK(fault(through({{0, 0, 0}, {70000, 0, 0}}), 1) ==
          "the rig, 70000 long, needs more than 65534 planes at a spacing of 1; 65534 is the most");
    CHECK(failure_of([&] {
              build_lattice(through({{0, 0, 0}, {30, 0, 0}}), spec(0.001, {-1, 1}, {-1, 1}));
          }) ==
          "a spacing of 0.001 makes 2001 x 2001 x 30001 vertices, which take 240 GB in each frame; "
          "take about the size of a voxel, and 0.0025 at least");
    CHECK(fault(through({{0, 0, 0}, {2, 0, 0}, {2, 0.004, 0}, {0, 0.004, 0}}), 0.5) ==
          "the rig turns right back within one spacing near (2, 0, 0), plane 4; smooth it, or take "
          "another spacing");
}

TEST_CASE("a lattice is the same a million units away") {
    const Vec3d far(1e6, -1e6, 1e6);
    std::vector<Rig> rigs{circle_rig({0, 0, 0}, {0, 0, 1}, {1.15, 1.15}, 0),
                          circle_rig({0, 0, 0}, {0, 1, 1}, {2, 1.2}, 0.3)};
    std::vector<Vec3d> bent;
    for (int n = 0; n < 20; ++n)
        bent.emplace_back(std::cos(0.25 * n), std::sin(0.25 * n), 0.03 * n);
    rigs.push_back(through(bent, false, {0, 0, 1}));
    rigs.push_back(through(bent, true, {0, 0, 1}));
    for (const auto& rig : rigs) {
        auto moved = rig;
        for (auto& point : moved.points) point += far;
        if (moved.oval) moved.oval->center += far;
        auto settings = spec(0.0555556, {-0.2, 0.2}, {-0.3, 0.3});
        for (settings.around = false;; settings.around = true) {
            INFO(to_text(rig));
            const auto here = build_lattice(rig, settings).lattice,
                       there = build_lattice(moved, settings).lattice;
            REQUIRE(here.shape == there.shape);
            for (std::size_t k = 0; k < here.planes.size(); ++k) {
                const auto &a = here.planes[k], &b = there.planes[k];
                CHECK((a.origin + far - b.origin).length() < 1e-8);
                CHECK((a.u - b.u).length() + (a.v - b.v).length() + (a.w - b.w).length() < 1e-7);
            }
            if (settings.around) break;
        }
    }
}

TEST_CASE("closed rigs of other lengths are divided into the same number of planes") {
    const auto circle = [](double radius) {
        return circle_rig({0, 0, 0}, {0, 0, 1}, {radius, radius}, 0);
    };
    const Run run("{spacing: 0.1, extent_u: [-0.5, 0.5], extent_v: [-0.2, 0.2]}",
                  {circle(2), circle(3)}, {1, 2});
    REQUIRE(run.heard.warnings.size() == 1);
    CHECK(run.heard.warnings[0] ==
          "the rig needs 188 planes in frame 2, but 126 in frame 1; all frames get 188 planes, "
          "which are 0.06684 apart in frame 1 instead of 0.1");
    CHECK(run.lattices[0]->shape == run.lattices[1]->shape);
    CHECK((run.lattices[0]->position(Vec3d(5, 2, 94)) - Vec3d(-2, 0, 0)).length() < 1e-9);
}
