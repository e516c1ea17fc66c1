#include "carve/lattice/mapping.h"
#include "carve/lattice/block_places.h"
#include "carve/lattice/build.h"
#include "carve/lattice/overlap.h"
#include "carve/rig/circle.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/failure_of.h"

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

/// Where `w` may be in a lattice.
double end(const Lattice& lattice) { return lattice.shape[2] - (lattice.closed ? 0 : 1); }

Vec3d random_place(std::mt19937& random, const Lattice& lattice) {
    return {between(random, 0, lattice.shape[0] - 1), between(random, 0, lattice.shape[1] - 1),
            between(random, 0, end(lattice))};
}

/// The distance of lattice coordinates, around the ring of a closed lattice.
double distance(const Lattice& lattice, const Vec3d& a, const Vec3d& b) {
    auto off = a - b;
    if (lattice.closed) off.z() -= lattice.shape[2] * std::round(off.z() / lattice.shape[2]);
    return off.length();
}

openvdb::math::Transform::Ptr turned_voxels(double size, const Vec3d& place) {
    const auto out = openvdb::math::Transform::createLinearTransform(size);
    out->preRotate(0.4, openvdb::math::Y_AXIS);
    out->preRotate(-0.7, openvdb::math::X_AXIS);
    out->postTranslate(place);
    return out;
}

/// Two legs, 12 apart, of 20 planes each and a half circle between them; u points from one leg to
/// the other.
Lattice hairpin() {
    std::vector<Lattice::Plane> planes;
    const auto add = [&](const Vec3d& middle, const Vec3d& w) {
        const auto u = Vec3d(0, 0, 1).cross(w);
        planes.push_back({middle - 2.0 * u - Vec3d(0, 0, 2), u, Vec3d(0, 0, 1), w});
    };
    for (int x = -20; x < 0; ++x) add(Vec3d(x, 0, 0), Vec3d(1, 0, 0));
    for (int n = 0; n <= 20; ++n) {
        const double a = M_PI * n / 20;
        add(Vec3d(6 * std::sin(a), 6 - 6 * std::cos(a), 0), Vec3d(std::cos(a), std::sin(a), 0));
    }
    for (int x = -1; x >= -20; --x) add(Vec3d(x, 12, 0), Vec3d(-1, 0, 0));
    const int count = static_cast<int>(planes.size());
    return with_planes({5, 5, count}, 1.0, false, planes, "hairpin");
}

/// Compares the places of a grid's voxels, found block by block, with those found one by one.
/// @return the number of voxels in the lattice
int compared_in_blocks(std::mt19937& random, const Lattice& lattice,
                       const openvdb::math::Transform& transform, int blocks) {
    const Mapping mapping(lattice, {lattice.shape[0] + 2, lattice.shape[1], lattice.shape[2]});
    BlockPlaces places(mapping, transform);
    int compared = 0;
    for (int m = 0; m < blocks; ++m) {
        const auto middle =
            Coord::round(transform.worldToIndex(mapping.position(random_place(random, lattice))));
        const Coord block(middle.x() & ~7, middle.y() & ~7, middle.z() & ~7);
        const auto range = places.move_to(block);
        for (int row = 0; row < 64; ++row)
            for (const auto& offset :
                 {Vec3d(0), Vec3d(-0.5, 0, 0), Vec3d(0, -0.5, 0), Vec3d(0, 0, -0.5)}) {
                const auto first = block.offsetBy(row >> 3, row & 7, 0);
                BlockPlaces::Row found;
                places.locate(first, offset, found);
                for (int z = 0; z < 8; ++z) {
                    const auto p = first.offsetBy(0, 0, z).asVec3d() + offset;
                    const auto world = transform.indexToWorld(p);
                    const auto single = mapping.locate(world);
                    REQUIRE(single.has_value() == ((found.inside >> z & 1) != 0));
                    if (!single) continue;
                    const auto& place = found.places[static_cast<std::size_t>(z)];
                    REQUIRE(distance(lattice, place.at, *single) < 1e-9);
                    const auto source = place.at + Vec3d(3, -1, 0);
                    const auto moved =
                        transform.indexToWorld(places.moved(p, place, openvdb::Vec3d(3, -1, 0)));
                    // A place at a plane is snapped to it, its direction is not.
                    const double tolerance =
                        place.at.z() == std::round(place.at.z()) ? snap_width : 1e-9;
                    REQUIRE(
                        (moved - (world + mapping.position(source) - mapping.position(place.at)))
                            .length() < tolerance);

                    const double w = place.at.z() < range.min().z() - snap_width
                                         ? place.at.z() + lattice.shape[2]
                                         : place.at.z();
                    for (const auto& [value, axis] :
                         {std::pair{place.at.x(), 0}, std::pair{place.at.y(), 1},
                          std::pair{w, 2}}) {
                        REQUIRE(value >= range.min()[axis] - snap_width);
                        REQUIRE(value <= range.max()[axis] + snap_width);
                    }
                    ++compared;
                }
            }
    }
    return compared;
}

}  // namespace

TEST_CASE("a position between bent planes comes back from its lattice coordinates") {
    std::mt19937 random(3);
    double worst = 0, worst_place = 0;
    for (int n = 0; n < 100; ++n) {
        const auto lattice =
            n == 0 ? helix({9, 7, 90}, 0.3, 4, 2) : random_bent(random, n % 2 == 0);
        const Mapping mapping(lattice);
        REQUIRE(mapping.slabs());
        for (int m = 0; m < 1000; ++m) {
            const auto place = random_place(random, lattice);
            const auto world = mapping.position(place);
            const auto found = mapping.locate(world);
            INFO("lattice " << n << ", place " << place);
            REQUIRE(found);
            worst = std::max(worst, (mapping.position(*found) - world).length() / lattice.spacing);
            worst_place = std::max(worst_place, distance(lattice, *found, place));
        }
    }
    CHECK(worst < 1e-4);
    CHECK(worst_place < 1e-4);
}

TEST_CASE("the true inverse beats the paper's closed form") {
    std::mt19937 random(4);
    double exact = 0, closed_form = 0, exact_sum = 0, closed_form_sum = 0;
    int points = 0, missed = 0;
    for (int n = 0; n < 20; ++n) {
        const auto lattice = random_bent(random, n % 2 == 0);
        auto papers = lattice;
        papers.closed_form = true;
        const Mapping mapping(lattice), by_closed_form(papers);
        for (int m = 0; m < 1000; ++m) {
            const auto world = mapping.position(random_place(random, lattice));
            const auto error = [&](const Vec3d& place) {
                return (mapping.position(place) - world).length() / lattice.spacing;
            };
            const auto theirs = by_closed_form.locate(world);
            if (!theirs) {
                ++missed;
                continue;
            }
            const double ours = error(*mapping.locate(world));
            exact = std::max(exact, ours);
            exact_sum += ours;
            closed_form = std::max(closed_form, error(*theirs));
            closed_form_sum += error(*theirs);
            ++points;
        }
    }
    WARN("|g(f(p)) - p| in spacings, mean and worst of "
         << points << ": exact " << exact_sum / points << ", " << exact << "; closed form "
         << closed_form_sum / points << ", " << closed_form << " (" << missed << " missed)");
    CHECK(points > 15000);
    CHECK(exact < 1e-4);
    CHECK(closed_form > 100 * exact);
    CHECK(closed_form_sum > 100 * exact_sum);
}

TEST_CASE("around a circle, lattice coordinates are polar coordinates") {
    const double spacing = 0.25;
    const Vec3d centre(1, -2, 3);
    const auto lattice = ring(centre, {17, 5, 100}, spacing, Vec2d(-2, -0.5));
    const Mapping mapping(lattice);
    const double rig = ring_radius(100, spacing), inner = rig - 2;
    std::mt19937 random(5);
    const auto place_at = [&](double radius, double turn, double height) {
        const double angle = -2 * M_PI * turn / 100;
        return mapping.locate(centre +
                              Vec3d(radius * std::cos(angle), radius * std::sin(angle), height));
    };
    for (int n = 0; n < 10000; ++n) {
        const double radius = between(random, inner + 0.01, inner + 3.99),
                     height = between(random, -0.5, 0.5), turn = between(random, 0, 100);
        const auto on_plane = place_at(radius, std::floor(turn), height);
        REQUIRE(on_plane);
        CHECK(distance(lattice, *on_plane,
                       Vec3d((radius - inner) / spacing, (height + 0.5) / spacing,
                             std::floor(turn))) < 2 * snap_width);
        const auto found = place_at(radius, turn, height);
        REQUIRE(found);
        const double sagitta = radius * spacing * spacing / (8 * rig * rig);
        CHECK(std::abs(inner + spacing * found->x() - radius) <
              1.01 * sagitta + spacing * snap_width);
    }
    // The ring closes on itself: what is at plane 100 is at plane 0.
    CHECK(mapping.locate(mapping.position(Vec3d(3, 2, 100))) == Vec3d(3, 2, 0));
    CHECK(mapping.locate(mapping.position(Vec3d(3, 2, 99.75)))->z() == Approx(99.75));
    CHECK((mapping.position(Vec3d(3, 2, -0.25)) - mapping.position(Vec3d(3, 2, 99.75))).length() <
          1e-12);
    CHECK(!place_at(inner - 0.01, 3, 0));
    CHECK(place_at(inner - 0.5 * rim_slack * spacing, 3, 0)->x() == 0);
}

TEST_CASE("a straight lattice of planes maps as a box does") {
    auto box = make_box(Vec3d(0.3, -7, 11), {9, 8, 7}, 0.1, {1, 2, 0});
    const auto mirrored = make_box(Vec3d(0.3, -7, 11), {9, 8, 7}, 0.1, {0, 2, 1});
    std::mt19937 random(6);
    for (const auto& lattice : {box, mirrored}) {
        const auto planes = as_planes(lattice);
        REQUIRE(!planes.is_box());
        const Mapping straight(lattice), general(planes);
        CHECK(general.locate(general.position(Vec3d(8.00009, -0.00009, -0.00009))) ==
              Vec3d(8, 0, 0));
        CHECK(general.locate(general.position(Vec3d(8, 0, 6.00009))) == Vec3d(8, 0, 6));
        CHECK(general.locate(general.position(Vec3d(4, 3, 5.000009))) == Vec3d(4, 3, 5));
        for (const auto& out :
             {Vec3d(8.0002, 0, 3), Vec3d(0, -0.0002, 3), Vec3d(0, 0, 6.0002), Vec3d(0, 0, -0.0002)})
            CHECK(!general.locate(general.position(out)));
        int inside = 0;
        for (int n = 0; n < 20000; ++n) {
            const Vec3d place(between(random, -1, 9), between(random, -1, 8),
                              between(random, -1, 7));
            const auto world = straight.position(place);
            REQUIRE((general.position(place) - world).length() < 1e-9);
            const auto a = straight.locate(world), b = general.locate(world);
            REQUIRE(a.has_value() == b.has_value());
            if (a) REQUIRE((*a - *b).length() < 1e-9);
            inside += a.has_value();
        }
        CHECK(inside > 8000);
    }
}

TEST_CASE("a block's voxels are found where they are found one by one") {
    std::mt19937 random(7);
    int compared = 0;
    for (int n = 0; n < 12; ++n) {
        const auto lattice = random_bent(random, n % 2 == 0);
        compared += compared_in_blocks(
            random, lattice,
            *turned_voxels(lattice.spacing * between(random, 0.6, 1.5), Vec3d(0.3, 0.1, 0.7)), 40);
    }
    CHECK(compared > 20000);
}

TEST_CASE(
    "a block's voxels are found where they are found one by one, too, if the rig keeps to a plane "
    "of the voxels") {
    std::mt19937 random(9);
    LatticeSpec spec;
    spec.spacing = 1;
    spec.u = {-5, 6};
    spec.v = {-7, 5};
    for (const auto& axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}) {
        const auto lattice =
            build_lattice(circle_rig(Vec3d(0.3, 2, -0.7), axis, {12, 12}, 0), spec).lattice;
        CHECK(compared_in_blocks(random, lattice,
                                 *openvdb::math::Transform::createLinearTransform(0.8),
                                 40) > 10000);
    }
}

TEST_CASE("the world box of a range holds its points, also across the closing planes") {
    std::mt19937 random(8);
    for (int n = 0; n < 40; ++n) {
        const auto lattice = random_bent(random, n % 2 == 0);
        const Mapping mapping(lattice);
        const auto a = random_place(random, lattice), b = random_place(random, lattice);
        BBoxd range(openvdb::math::minComponent(a, b), openvdb::math::maxComponent(a, b));
        if (lattice.closed) range.max().z() += 5;
        auto box = mapping.world_box(range);
        box.min() -= Vec3d(1e-12);
        box.max() += Vec3d(1e-12);
        for (int m = 0; m < 500; ++m)
            REQUIRE(box.isInside(
                mapping.position({between(random, range.min().x(), range.max().x()),
                                  between(random, range.min().y(), range.max().y()),
                                  between(random, range.min().z(), range.max().z())})));
    }
}

TEST_CASE(
    "a lattice that runs over itself is entered at its lowest plane, and the voxels in several "
    "cells are counted") {
    // A circle of 60 planes that goes on for another 15.
    const auto circle = ring(Vec3d(0.1, 0.2, 0.3), {9, 6, 60}, 1.0, Vec2d(-4, -2));
    auto planes = circle.planes;
    for (std::size_t k = 0; k <= 15; ++k) planes.push_back(circle.planes[k]);
    const auto lattice = with_planes({9, 6, 76}, 1.0, false, planes, "more than a turn");
    const Mapping once(circle), more(lattice);

    const auto transform = turned_voxels(0.8, Vec3d(0.1));
    std::size_t shared = 0, inside = 0;
    for (auto at = CoordBBox(Coord(-30), Coord(30)).begin(); at; ++at) {
        const auto world = transform->indexToWorld(*at);
        const auto place = once.locate(world), found = more.locate(world);
        REQUIRE(place.has_value() == found.has_value());
        if (!place) continue;
        ++inside;
        shared += place->z() < 15;
        REQUIRE((*place - *found).length() < 1e-9);
    }
    REQUIRE(inside > 4000);
    const auto counted = count_overlap(more, *transform);
    CHECK(counted.voxels == shared);
    CHECK(counted.plane < 15);
    CHECK(count_overlap(once, *transform).voxels == 0);
    CHECK(
        count_overlap(Mapping(make_box(Vec3d(0), {4, 4, 4}, 1.0, {0, 1, 2})), *transform).voxels ==
        0);
    std::size_t alone = 0;
    tbb::task_arena(1).execute([&] { alone = count_overlap(more, *transform).voxels; });
    CHECK(alone == shared);
}

TEST_CASE("cells of the lattice win over those by which insertions extend it") {
    const auto lattice = hairpin();
    const int last = lattice.shape[2];
    const Mapping plain(lattice), extended(lattice, {15, 5, last});
    const auto on_second_leg = plain.position(Vec3d(3, 2, last - 10.5));
    const auto on_first_leg = plain.position(Vec3d(3, 2, 9.5));
    for (const auto& world : {on_second_leg, on_first_leg})
        CHECK(extended.locate(world) == plain.locate(world));
    // In the middle between the legs both extensions meet: the lowest plane has it.
    CHECK(!plain.locate(Vec3d(-10.5, 6, 0)));
    CHECK(extended.locate(Vec3d(-10.5, 6, 0))->z() == Approx(9.5));
    const auto voxels = openvdb::math::Transform::createLinearTransform(0.5);
    CHECK(count_overlap(plain, *voxels).voxels == 0);
    CHECK(count_overlap(extended, *voxels).voxels > 1000);
}

TEST_CASE("eight cubics at once have the root that one has, or say that they do not know it") {
    std::mt19937 random(12);
    int solved = 0, unsolved = 0;
    for (int n = 0; n < 2000; ++n) {
        CubicRow row;
        for (std::size_t z = 0; z < 8; ++z) {
            // From gentle ones to such that Newton's method from the secant's root is far from
            // done.
            const double bend = std::pow(10, between(random, -6, -0.2)),
                         root = between(random, 0, 1);
            const double q3 = bend * between(random, -0.3, 0.3), q2 = bend * between(random, -1, 1),
                         q1 = -1 - 2 * bend;
            row.set(z, {-((q3 * root + q2) * root + q1) * root, q1, q2, q3});
        }
        row.solve();
        for (std::size_t z = 0; z < 8; ++z) {
            const double root = cubic_root(row.at(z), 0, 1);
            const auto [q0, q1, q2, q3] = row.at(z);
            REQUIRE(std::abs(((q3 * root + q2) * root + q1) * root + q0) < 1e-12);
            if (row.solved(z, 0, 1)) {
                ++solved;
                REQUIRE(std::abs(row.c[z] - root) < 3e-13);
            } else {
                ++unsolved;
            }
        }
    }
    CHECK(solved > 5000);
    CHECK(unsolved > 500);
    CubicRow level{};
    level.solve();
    CHECK(!level.solved(0, 0, 1));
}

TEST_CASE("too few planes do not bend") {
    auto lattice = make_box(Vec3d(0), {3, 3, 2}, 1.0, {0, 1, 2});
    lattice.closed = true;
    CHECK(failure_of([&] { Mapping{lattice}; }) ==
          "the lattice (" + lattice.description + ") has 2 planes; a closed one needs at least 3");
    lattice.closed = false;
    lattice.planes.pop_back();
    lattice.planes[0].u = lattice.planes[0].v;
    CHECK(failure_of([&] { Mapping{lattice}; }) ==
          "the lattice (" + lattice.description +
              ") has 1 plane; one that is no straight box needs at least 2");
}
