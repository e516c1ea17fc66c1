#include "nodes/preview/sheet_rows.h"
#include "tests/support/node_bench.h"
#include "tests/support/seams_through.h"
#include "tests/support/sheets.h"
#include "tests/support/warped.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

/// A lattice of 10 x 1 x 4 vertices on the voxels (0, 5, 0) to (9, 5, 3), u along x, and seams of
/// one entry each in every column of frames 1 to 3.
Lattice row_lattice() { return make_box({0, 5, 0}, {10, 1, 4}, 1, {0, 1, 2}); }

Seams straight(const Lattice& lattice, Seams::Kind kind, const std::vector<int>& entries) {
    return straight_seams(lattice, Axis::u, kind, entries, {1, 2, 3});
}

/// Where lines cross a height, from the left.
std::vector<double> crossings(const std::vector<PictureLine>& lines, double height) {
    std::vector<double> out;
    for (const auto& [from, to] : lines)
        if ((from[1] < height) != (to[1] < height))
            out.push_back(from[0] + (to[0] - from[0]) * (height - from[1]) / (to[1] - from[1]));
    std::ranges::sort(out);
    return out;
}

std::vector<double> rounded(std::vector<double> values) {
    for (auto& value : values) value = std::round(value * 1e6) / 1e6;
    return values;
}

using Doubles = std::vector<double>;

}  // namespace

TEST_CASE("removed seams are drawn where they were before any of them was removed") {
    const auto lattice = row_lattice();
    const auto space = openvdb::math::Transform::createLinearTransform(1);
    // Index 3 four times over, in the space that the earlier ones leave: originally 3, 4, 5 and 6.
    // Then 0, and then 0 again: 0 and 1.
    const auto seams = straight(lattice, Seams::Kind::remove, {3, 3, 3, 3, 0, 0});
    const auto lines = seam_lines(lattice, seams, 2, *space, View::y, 5);
    CHECK(rounded(crossings(lines, 2.25)) == Doubles{0.5, 1.5, 3.5, 4.5, 5.5, 6.5});
    // Lines reach the outer borders of the lattice's voxels, and no further.
    CHECK(crossings(lines, 0.01).size() == 6);
    CHECK(crossings(lines, 3.99).size() == 6);
    CHECK(crossings(lines, -0.01).empty());
    CHECK(crossings(lines, 4.01).empty());
    CHECK(seam_lines(lattice, seams, 2, *space, View::y, 6).empty());
}

TEST_CASE("inserted seams are drawn half a vertex behind those that they double") {
    const auto lattice = row_lattice();
    const auto space = openvdb::math::Transform::createLinearTransform(1);
    CHECK(rounded(crossings(seam_lines(lattice, straight(lattice, Seams::Kind::insert, {7, 2}), 1,
                                       *space, View::y, 5),
                            1.25)) == Doubles{3, 8});
}

TEST_CASE("a seam that bends is drawn as it bends, in the space of the picture") {
    const auto lattice = make_box({0, 0, 0}, {8, 3, 3}, 1, {0, 2, 1});
    Seams seams;
    seams.shape = lattice.shape;
    seams.frames = {1};
    seams.lattice_hash = lattice.hash;
    // Columns are (j, k), j along z and k along y.
    seams.seams.push_back({{1, 2, 3, 4, 5, 6, 7, 7, 7}, 0});
    const auto fine = openvdb::math::Transform::createLinearTransform(0.5);
    const auto lines = seam_lines(lattice, seams, 1, *fine, View::y, 2);
    CHECK(rounded(crossings(lines, 0.5001)).front() == Approx(8.5).margin(1e-3));
    CHECK(rounded(crossings(lines, 2.5001)).front() == Approx(10.5).margin(1e-3));
    CHECK(rounded(crossings(lines, 4.4999)).front() == Approx(12.5).margin(1e-3));
    // Across z lie the columns of one j.
    CHECK(rounded(crossings(seam_lines(lattice, seams, 1, *fine, View::z, 4), 2.5001)).front() ==
          Approx(12.5).margin(1e-3));
}

TEST_CASE("seams are drawn over the energy in a colour of their own, and counted") {
    auto frame = frame_of(1, cube(Coord(0), 10, 1.0f), nullptr);
    const auto lattice = row_lattice();
    frame.energy = cube(Coord(0), 10, 1.0f);
    frame.lattice = std::make_shared<Lattice>(lattice);
    frame.seams = std::make_shared<Seams>(straight(lattice, Seams::Kind::remove, {3, 3}));
    auto request = request_for();
    request.slice = 5;
    const auto page = page_of(request, {frame});
    CHECK(names_of(page).back() == "seams over energy: slice at y = 5");
    CHECK(page.summary == "1 of 1 frame; 2 seams removed across u");
    const auto sheet = draw_sheet(page);
    const auto line = find(sheet, seam_colour);
    const auto picture = find(sheet, heat(1));
    REQUIRE(line.count > 0);
    CHECK(line.top > (picture.top + picture.bottom) / 2);
    const double voxel = (picture.right - picture.left + 1) / 10.0;
    CHECK((line.left - picture.left) / voxel == Approx(3.5).margin(0.2));
    CHECK((line.right - picture.left) / voxel == Approx(4.5).margin(0.2));

    request.slice = 7;
    CHECK(names_of(page_of(request, {frame})).back() ==
          "seams over energy: slice at y = 7; no seam crosses it");
    request.view = View::x;
    CHECK(names_of(page_of(request, {frame})).back() ==
          "seams over energy: slice at x = 7; seams face this view, choose another axis");
}

TEST_CASE("seams of another lattice or without the frame shown are a failure") {
    const auto lattice = row_lattice();
    const auto seams = straight(lattice, Seams::Kind::remove, {3});
    CHECK(failure_of([&] { require_seams(lattice, seams, 7); }) ==
          "the seams do not hold frame 7; they hold 1-3");
    const auto other = make_box({0, 6, 0}, {10, 1, 4}, 1, {0, 1, 2});
    CHECK(failure_of([&] { require_seams(other, seams, 1); }) ==
          "the seams were found in another lattice: theirs is a box of 10 x 1 x 4 vertices from "
          "(0, 5, 0) to (9, 5, 3), spacing 1, axes xyz (" +
              lattice.hash +
              "), this one a box of 10 x 1 x 4 vertices from (0, 6, 0) to (9, 6, 3), spacing 1, "
              "axes xyz (" +
              other.hash + ")");
}

TEST_CASE("a warp is drawn where it moves content by a whole number of vertices and a half") {
    const auto lattice = row_lattice();
    const auto space = openvdb::math::Transform::createLinearTransform(1);
    // By 0 to -4.5 along u: -0.5 at vertex 1, -1.5 at vertex 3 and so on.
    const auto even = warped(lattice, evenly(lattice, -4.5), Axis::u, {1, 2, 3});
    CHECK(rounded(crossings(seam_lines(lattice, even, 2, *space, View::y, 5), 2.25)) ==
          Doubles{1.5, 3.5, 5.5, 7.5});
    // It goes and comes back, and only up to plane 1.
    const auto bump = warped(lattice,
                             [](int entry, int, int k, int) {
                                 return k > 1 ? 0.0 : entry < 5 ? 0.4 * entry : 0.4 * (9 - entry);
                             },
                             Axis::u, {1, 2, 3});
    const auto lines = seam_lines(lattice, bump, 2, *space, View::y, 5);
    CHECK(rounded(crossings(lines, 0.75)) == Doubles{1.75, 4.25, 5.75, 8.25});
    CHECK(crossings(lines, 2.75).empty());
}
