#include "nodes/preview/overlay.h"
#include "nodes/preview/sheet_rows.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/seams_through.h"
#include "tests/support/sheets.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

using Offsets = std::set<double>;

/// All positions of the ends of lines along a side of the picture.
Offsets ends(const std::vector<PictureLine>& lines, std::size_t side) {
    Offsets out;
    for (const auto& [from, to] : lines)
        out.insert({std::round(from[side] * 1e6) / 1e6, std::round(to[side] * 1e6) / 1e6});
    return out;
}

const auto unit_space = openvdb::math::Transform::createLinearTransform(1);

Rig rig_of(const std::vector<Vec3d>& points, bool closed) {
    return {points, closed, Vec3d(0, 0, 1), {}};
}

/// A frame with a cube of 10 voxels, before and after.
SheetFrame cube_frame() { return frame_of(1, cube(Coord(0), 10, 1.0f), cube(Coord(0), 10, 0.5f)); }

}  // namespace

TEST_CASE("a lattice is drawn by its planes and the lines through their corners") {
    // u along x, w along z: of each plane two edges lie over each other, and two run along the
    // view.
    const auto box = make_box({0, 5, 0}, {10, 2, 4}, 1, {0, 1, 2});
    const auto lines = lattice_lines(box, *unit_space, View::y);
    CHECK(lines.size() == 4 * 2 + 4 * 3);
    CHECK(ends(lines, 0) == Offsets{0.5, 9.5});
    CHECK(ends(lines, 1) == Offsets{0.5, 1.5, 2.5, 3.5});
    // In the voxels of the picture, and along another axis.
    const auto fine = openvdb::math::Transform::createLinearTransform(0.5);
    const auto above = lattice_lines(box, *fine, View::z);
    CHECK(ends(above, 0) == Offsets{0.5, 18.5});
    CHECK(ends(above, 1) == Offsets{10.5, 12.5});
    // Of many planes about 16, of their corners all.
    CHECK(lattice_lines(make_box({0, 5, 0}, {10, 2, 161}, 1, {0, 1, 2}), *unit_space, View::y)
              .size() == 16 * 2 + 4 * 160);
}

TEST_CASE("the lines around a closed lattice close") {
    const auto around = ring(Vec3d(0), {3, 1, 12}, 1, {-1, 0});
    const auto lines = lattice_lines(around, *unit_space, View::z);
    // A lattice one vertex high has two edges per plane that lie over each other; two corners lie
    // on two others.
    REQUIRE(lines.size() == 12 * 2 + 4 * 12);
    const auto outer = ring_radius(12, 1) + 1;
    double way = 0;
    for (const auto& [from, to] : lines)
        if (std::hypot(from[0] - 0.5, from[1] - 0.5) > outer - 1e-6 &&
            std::hypot(to[0] - 0.5, to[1] - 0.5) > outer - 1e-6)
            way += std::hypot(to[0] - from[0], to[1] - from[1]);
    CHECK(way == Approx(2 * 12 * 2 * outer * std::sin(M_PI / 12)));
}

TEST_CASE("a rig is drawn as it goes, without what can't be seen") {
    const std::vector<Vec3d> points{{0, 0, 0}, {4, 0, 0}, {4, 7, 0}, {4, 7, 3}};
    const auto open = rig_lines(rig_of(points, false), *unit_space, View::y);
    // The part along y is seen from its end.
    REQUIRE(open.size() == 2);
    CHECK(open[0].from == std::array{0.5, 0.5});
    CHECK(open[0].to == std::array{4.5, 0.5});
    CHECK(open[1].from == std::array{4.5, 0.5});
    CHECK(open[1].to == std::array{4.5, 3.5});
    const auto closed = rig_lines(rig_of(points, true), *unit_space, View::y);
    REQUIRE(closed.size() == 3);
    CHECK(closed[2].to == std::array{0.5, 0.5});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(rig_lines(rig_of({{0, 0, 0}, {nan, 0, 0}, {1, 0, 0}}, false), *unit_space, View::y)
              .empty());
}

TEST_CASE("lattice and rig lie over all pictures of a sheet, seams over the energy") {
    const auto lattice = make_box({0, 5, 0}, {10, 1, 4}, 1, {0, 1, 2});
    auto frame = cube_frame();
    frame.energy = cube(Coord(0), 10, 1.0f);
    frame.lattice = std::make_shared<Lattice>(lattice);
    frame.rig = std::make_shared<Rig>(rig_of({{4, 5, 0}, {4, 5, 9}}, false));
    frame.seams =
        std::make_shared<Seams>(straight_seams(lattice, Axis::u, Seams::Kind::remove, {3}, {1}));
    auto request = request_for(View::y, {SheetRequest::Show::maximum, SheetRequest::Show::slice});
    request.slice = 5;
    const auto drawn = [&](Colour colour) {
        return find(draw_sheet(page_of(request, {frame})), colour).count;
    };
    CHECK(drawn(lattice_colour) == 0);
    CHECK(drawn(rig_colour) == 0);
    CHECK(drawn(seam_colour) > 0);

    request.lattice = request.rig = true;
    request.seams = false;
    const auto page = page_of(request, {frame});
    REQUIRE(page.rows.size() == 5);
    for (const auto& row : page.rows) {
        CHECK(row.panels[0].lattice.size() == lattice_lines(lattice, *unit_space, View::y).size());
        CHECK(row.panels[0].rig.size() == 1);
        CHECK(row.panels[0].seams.empty());
    }
    CHECK(names_of(page).back() == "energy: slice at y = 5");
    CHECK(drawn(lattice_colour) > 0);
    CHECK(drawn(rig_colour) > 0);
    CHECK(drawn(seam_colour) == 0);
    // The rig goes up through the middle of column 4.
    const auto sheet = draw_sheet(page);
    const auto line = find(sheet, rig_colour), picture = find(sheet, heat(1));
    const double voxel = (picture.right - picture.left + 1) / 10.0;
    CHECK((line.left - picture.left) / voxel == Approx(4.5).margin(0.2));
    CHECK((line.right - picture.left) / voxel == Approx(4.5).margin(0.2));
}

TEST_CASE(
    "a lattice beyond the content widens the picture, but by no more than the content's size on "
    "each side") {
    auto frame = cube_frame();
    auto request = request_for();
    const auto width = [&](double first, double spacing) {
        frame.lattice = std::make_shared<Lattice>(
            make_box(Vec3d(first, 0, first), {2, 1, 2}, spacing, {0, 1, 2}));
        const auto cubes = find(draw_sheet(page_of(request, {frame})), heat(1));
        return cubes.right - cubes.left;
    };
    const auto without = width(0, 1);
    request.lattice = true;
    // The outlines of both boxes do not meet the cube.
    CHECK(width(-1000, 2010) < without);
    CHECK(width(-1000, 2010) == width(-1e6, 3e6));
    CHECK(width(-1000, 2010) == width(-1e12, 3e12));
    CHECK(width(2, 3) == without);
}
