#include "nodes/preview/difference.h"
#include "nodes/preview/sheet.h"
#include "nodes/preview/sheet_rows.h"
#include "nodes/preview/slice.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"
#include "tests/support/seams_through.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

FloatGrid::Ptr named(const std::string& name) {
    auto out = FloatGrid::create(0.0f);
    out->setName(name);
    return out;
}

/// A cube of one value, as voxels.
FloatGrid::Ptr cube(const Coord& first, int size, float value) {
    auto out = named("density");
    out->denseFill(CoordBBox(first, first.offsetBy(size - 1)), value, true);
    return out;
}

SheetFrame frame_of(int number, FloatGrid::ConstPtr before, FloatGrid::ConstPtr after) {
    SheetFrame out;
    out.name = "frame " + std::to_string(number);
    out.number = number;
    out.before = std::move(before);
    out.after = std::move(after);
    return out;
}

SheetWish wish_for(View view = View::y, SheetWish::Show show = SheetWish::Show::maximum) {
    SheetWish out;
    out.grid = "density";
    out.view = view;
    out.show = show;
    out.difference = false;
    return out;
}

SheetPage page_of(const SheetWish& wish, const std::vector<SheetFrame>& frames) {
    SheetRows rows(wish);
    for (const auto& frame : frames) rows.add(frame);
    return rows.page(frames.size());
}

std::vector<std::string> names_of(const SheetPage& page) {
    std::vector<std::string> out;
    for (const auto& row : page.rows) out.push_back(row.name + ": " + row.what);
    return out;
}
using Names = std::vector<std::string>;

/// Pixels of a colour in the panels of a sheet, and the rectangle that they span.
constexpr int panels_left = 246;
struct Found {
    int count = 0;
    int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};
Found find(const Canvas& canvas, Colour colour) {
    Found out;
    for (int y = 92; y < canvas.height() - 32; ++y)
        for (int x = panels_left; x < canvas.width(); ++x)
            if (canvas.at(x, y) == colour) {
                ++out.count;
                out.left = std::min(out.left, x), out.right = std::max(out.right, x);
                out.top = std::min(out.top, y), out.bottom = std::max(out.bottom, y);
            }
    return out;
}

std::vector<std::size_t> shown_of(const std::string& count, int total) {
    const auto type = preview_sheet();
    const auto params = type.make_params();
    Problems problems;
    Value value;
    value.kind = Value::Kind::scalar;
    value.text = count;
    ValueReader reader(problems, "frames", type.param("frames")->range);
    type.param("frames")->parse(params.get(), value, reader);
    const auto behaviour = type.bind(params);
    std::vector<int> frames;
    for (int n = 0; n < total; ++n) frames.push_back(1001 + n);
    Context::Host host;
    Context context(host, frames);
    std::vector<std::size_t> out;
    for (std::size_t place = 0; place < frames.size(); ++place)
        if (behaviour.wants(context.at(place))) out.push_back(place);
    return out;
}
using Places = std::vector<std::size_t>;

Payload volume_of(const FloatGrid::Ptr& grid) { return Payload(std::make_shared<const Volume>(Volume{{grid}, {}, {}})); }

/// A lattice of 10 x 1 x 4 vertices on the voxels (0, 5, 0) to (9, 5, 3), u along x, and seams of one entry each in every
/// column of frames 1 to 3.
Lattice row_lattice() { return make_box({0, 5, 0}, {10, 1, 4}, 1, {0, 1, 2}); }
Seams straight(const Lattice& lattice, Seams::Kind kind, const std::vector<int>& entries) { return straight_seams(lattice, Axis::u, kind, entries, {1, 2, 3}); }

/// Where lines cross a height, from the left.
std::vector<double> crossings(const std::vector<PictureLine>& lines, double height) {
    std::vector<double> out;
    for (const auto& [from, to] : lines)
        if ((from[1] < height) != (to[1] < height)) out.push_back(from[0] + (to[0] - from[0]) * (height - from[1]) / (to[1] - from[1]));
    std::sort(out.begin(), out.end());
    return out;
}
std::vector<double> rounded(std::vector<double> values) {
    for (auto& value : values) value = std::round(value * 1e6) / 1e6;
    return values;
}
using Doubles = std::vector<double>;

}  // namespace

TEST_CASE("a maximum projection takes the greatest active value along its axis") {
    const auto grid = named("density");
    auto values = grid->getAccessor();
    for (int x = -9; x <= 9; ++x)
        for (int y = -3; y <= 12; ++y)
            for (int z = -20; z <= 20; ++z) values.setValueOn(Coord(x, y, z), static_cast<float>(100 * x + 10 * y + z));
    values.setValueOff(Coord(9, 12, 20), 1e6f);
    const CoordBBox box(Coord(-9, -3, -20), Coord(9, 12, 20));

    const auto along_x = maximum_projection(*grid, View::x, box);
    CHECK(along_x.cell == 1);
    CHECK(along_x.cells.size(0) == 16);
    CHECK(along_x.cells.size(1) == 41);
    CHECK(along_x.at(-3, -20) == 900 - 30 - 20);
    CHECK(along_x.at(12, 20) == 800 + 120 + 20);
    const auto along_y = maximum_projection(*grid, View::y, box);
    CHECK(along_y.at(-9, 20) == -900 + 120 + 20);
    CHECK(along_y.at(4, -7) == 400 + 120 - 7);
    const auto along_z = maximum_projection(*grid, View::z, box);
    CHECK(along_z.at(-9, 12) == -900 + 120 + 20);
    CHECK(along_z.at(0, 0) == 20);

    const auto part = maximum_projection(*grid, View::z, CoordBBox(Coord(-2, 0, -5), Coord(2, 1, 3)));
    CHECK(part.cells.size(0) == 5);
    CHECK(part.at(2, 1) == 200 + 10 + 3);
}

TEST_CASE("what is not active is not seen, NaN neither") {
    const auto grid = named("density");
    auto values = grid->getAccessor();
    values.setValueOn(Coord(0, 0, 0), -2.0f);
    values.setValueOn(Coord(1, 0, 0), std::numeric_limits<float>::quiet_NaN());
    values.setValueOn(Coord(1, 1, 0), 3.0f);
    values.setValueOn(Coord(1, 2, 0), std::numeric_limits<float>::quiet_NaN());
    const auto seen = maximum_projection(*grid, View::y, CoordBBox(Coord(0), Coord(2)));
    CHECK(seen.at(0, 0) == -2.0f);
    CHECK(seen.at(1, 0) == 3.0f);
    CHECK(std::isnan(seen.at(2, 0)));
    CHECK(std::isnan(seen.at(0, 1)));
}

TEST_CASE("tiles are seen without being made into voxels") {
    const auto grid = named("density");
    grid->sparseFill(CoordBBox(Coord(-128), Coord(127)), 2.0f, true);
    grid->tree().setValueOn(Coord(5, 60, 5), 7.0f);
    const auto leaves = grid->tree().leafCount();
    const auto seen = maximum_projection(*grid, View::z, CoordBBox(Coord(-130, 50, -130), Coord(10, 70, 0)));
    CHECK(std::isnan(seen.at(-129, 55)));
    CHECK(seen.at(-128, 50) == 2.0f);
    CHECK(seen.at(10, 70) == 2.0f);
    CHECK(seen.at(5, 60) == 2.0f);
    CHECK(maximum_projection(*grid, View::z, CoordBBox(Coord(-130, 50, 0), Coord(10, 70, 5))).at(5, 60) == 7.0f);
    CHECK(grid->tree().leafCount() == leaves);
}

TEST_CASE("of vectors the length is projected") {
    const auto grid = VectorGrid::create();
    grid->tree().setValueOn(Coord(0, 0, 0), {0, -3, 4});
    grid->tree().setValueOn(Coord(0, 1, 0), {1, 1, 1});
    CHECK(maximum_projection(*grid, View::y, CoordBBox(Coord(0), Coord(1))).at(0, 0) == 5.0f);
}

TEST_CASE("a large box is seen through larger cells, aligned in the whole index space") {
    const auto grid = named("density");
    grid->tree().setValueOn(Coord(-65, 0, -1), 1.0f);
    grid->tree().setValueOn(Coord(63, 0, 30), 2.0f);
    grid->tree().setValueOn(Coord(62, 5, 31), 3.0f);
    const CoordBBox box(Coord(-65, 0, -1), Coord(63, 5, 31));
    const auto seen = maximum_projection(*grid, View::y, box, 64);
    REQUIRE(seen.cell == 4);
    CHECK(seen.cells.first == std::array{-17, -1});
    CHECK(seen.cells.last == std::array{15, 7});
    CHECK(seen.at(-17, -1) == 1.0f);
    CHECK(seen.at(15, 7) == 3.0f);
    CHECK(std::isnan(seen.at(0, 0)));

    const auto same = fitted(maximum_projection(*grid, View::y, box), 4, seen.cells);
    for (std::size_t n = 0; n < seen.values.size(); ++n)
        CHECK((same.values[n] == seen.values[n] || (std::isnan(same.values[n]) && std::isnan(seen.values[n]))));
}

TEST_CASE("colours grow lighter with the value, evenly enough to read in grey") {
    double last = -1;
    for (int n = 0; n <= 100; ++n) {
        const auto colour = heat(n / 100.0);
        const double light = 0.2126 * colour.red + 0.7152 * colour.green + 0.0722 * colour.blue;
        CHECK(light >= last);
        last = light;
    }
    CHECK(heat(-1) == heat(0));
    CHECK(heat(2) == heat(1));
    CHECK_FALSE(heat(0) == heat(1));
}

TEST_CASE("opposite differences are equally light, and lighter the larger") {
    const auto light = [](const Colour& colour) { return 0.2126 * colour.red + 0.7152 * colour.green + 0.0722 * colour.blue; };
    for (int n = 1; n <= 20; ++n) {
        const double size = n / 20.0;
        CHECK(light(diverging(size)) > light(diverging(size - 0.05)));
        CHECK(light(diverging(-size)) > light(diverging(0.05 - size)));
        CHECK(light(diverging(size)) == Approx(light(diverging(-size))).margin(14));
        CHECK(diverging(size).red > diverging(size).blue);
        CHECK(diverging(-size).blue > diverging(-size).red);
    }
    CHECK(diverging(-2) == diverging(-1));
    CHECK(diverging(2) == diverging(1));
}

TEST_CASE("a difference is after minus before, and along a line of sight the largest with its sign") {
    const auto before = cube(Coord(0), 4, 1.0f);
    const auto after = cube(Coord(0), 4, 1.0f);
    after->tree().setValueOn(Coord(1, 0, 1), 1.5f);
    after->tree().setValueOn(Coord(1, 3, 1), 0.25f);
    after->tree().setValueOn(Coord(2, 1, 2), 3.0f);
    after->tree().setValueOn(Coord(3, 1, 3), std::numeric_limits<float>::quiet_NaN());
    const CoordBBox box(Coord(0), Coord(5));
    const auto seen = largest_difference(*before, *after, View::y, box);
    CHECK(seen.at(0, 0) == 0.0f);
    CHECK(seen.at(1, 1) == -0.75f);
    CHECK(seen.at(2, 2) == 2.0f);
    CHECK(seen.at(3, 3) == 0.0f);
    CHECK(std::isnan(seen.at(4, 0)));
    CHECK(largest_difference(*before, *after, View::y, slice_of(box, View::y, 0)).at(1, 1) == 0.5f);

    const auto old = VectorGrid::create();
    old->tree().setValueOn(Coord(0), {3, 4, 0});
    CHECK(largest_difference(*old, *VectorGrid::create(), View::z, CoordBBox(Coord(0), Coord(0))).at(0, 0) == -5.0f);
}

TEST_CASE("what only one of two grids holds differs from the other's background, in tiles too") {
    const auto before = named("density");
    before->sparseFill(CoordBBox(Coord(0), Coord(127)), 2.0f, true);
    const auto after = named("density");
    after->tree().setValueOn(Coord(130, 3, 3), 4.0f);
    after->tree().setValueOn(Coord(5, 5, 5), 2.0f);
    const auto seen = largest_difference(*before, *after, View::z, CoordBBox(Coord(0), Coord(135)));
    CHECK(seen.at(0, 0) == -2.0f);
    CHECK(seen.at(127, 127) == -2.0f);
    CHECK(seen.at(130, 3) == 4.0f);
    CHECK(largest_difference(*before, *after, View::z, CoordBBox(Coord(0, 0, 5), Coord(135, 135, 5))).at(5, 5) == 0.0f);
    CHECK(std::isnan(seen.at(129, 3)));
}

TEST_CASE("a slice shows one plane, by nearest voxels where the grid has another transform") {
    const auto grid = named("energy");
    for (int y = 0; y < 4; ++y) grid->tree().setValueOn(Coord(1, y, 2), static_cast<float>(y));
    const auto& space = grid->transform();
    CHECK(slice_in(*grid, space, View::y, 2).at(1, 2) == 2.0f);
    CHECK(slice_in(*grid, space, View::y, 4).empty());
    CHECK(slice_in(*named("energy"), space, View::y, 0).empty());
    const auto fine = openvdb::math::Transform::createLinearTransform(0.5);
    const auto seen = slice_in(*grid, *fine, View::y, 6);
    CHECK(seen.at(2, 4) == 3.0f);
    CHECK(std::isnan(seen.at(4, 4)));
}

TEST_CASE("before and after share one range of colours and one window") {
    const auto strong = cube(Coord(0), 16, 4.0f);
    const auto weak = cube(Coord(16, 0, 8), 8, 2.0f);
    const auto sheet = draw_sheet(page_of(wish_for(), {frame_of(1, strong, weak)}));
    const auto whole = find(sheet, heat(1));
    const auto half = find(sheet, heat(0.5));
    REQUIRE(whole.count > 0);
    REQUIRE(half.count > 0);
    // The window is 24 x 16 voxels: the weak cube has half the strong one's size and stands at its upper right.
    CHECK(whole.bottom < half.top);
    CHECK((half.right - half.left) * 2 == Approx(whole.right - whole.left).margin(6));
    CHECK((half.bottom - half.top) * 2 == Approx(whole.bottom - whole.top).margin(6));
    CHECK(half.left == Approx(whole.right).margin(5));
    const auto turned = draw_sheet(page_of(wish_for(), {frame_of(1, weak, strong)}));
    CHECK(find(turned, heat(0.5)).bottom < find(turned, heat(1)).top);
}

TEST_CASE("the range of values starts at 0, that of differences is the same on both sides") {
    auto wish = wish_for();
    wish.difference = true;
    const auto page =
        page_of(wish, {frame_of(1, cube(Coord(0), 4, 3.0f), cube(Coord(0), 4, 2.0f)), frame_of(2, cube(Coord(0), 4, 3.0f), cube(Coord(0), 4, 3.5f))});
    const auto values = range_of(page.rows, SheetRow::Scale::value);
    CHECK(values.low == 0);
    CHECK(values.high == 3.5);
    const auto changes = range_of(page.rows, SheetRow::Scale::change);
    CHECK(changes.low == -1);
    CHECK(changes.high == 1);
    const auto sheet = draw_sheet(page);
    CHECK(find(sheet, diverging(-1)).count > 100);
    CHECK(find(sheet, diverging(0.5)).count > 100);
    CHECK(find(sheet, diverging(-1)).right < find(sheet, diverging(0.5)).left);
    CHECK(range_of({}, SheetRow::Scale::change).low == -1);
    CHECK(range_of({}, SheetRow::Scale::energy).high == 1);
}

TEST_CASE("frames go across, kinds of picture down") {
    auto wish = wish_for(View::y, SheetWish::Show::both);
    wish.difference = true;
    const auto page =
        page_of(wish, {frame_of(1, cube(Coord(0), 8, 1.0f), cube(Coord(0), 8, 2.0f)), frame_of(2, cube(Coord(0), 8, 3.0f), cube(Coord(0), 8, 4.0f))});
    CHECK(page.frames == Names{"frame 1", "frame 2"});
    CHECK(names_of(page) == Names{"before: maximum along y", "after: maximum along y", "difference: after - before, largest along y", "before: slice at y = 3",
                                  "after: slice at y = 3", "difference: after - before, slice at y = 3"});
    const auto sheet = draw_sheet(page);
    const auto before_1 = find(sheet, heat(0.25)), after_1 = find(sheet, heat(0.5)), before_2 = find(sheet, heat(0.75));
    REQUIRE(before_1.count > 0);
    CHECK(before_1.right < before_2.left);
    CHECK(before_1.top == before_2.top);
    CHECK(before_1.left == after_1.left);
    CHECK(before_1.top < after_1.top);
    CHECK(before_1.count == before_2.count);
}

TEST_CASE("rows whose inputs are missing or that are not wanted are left out") {
    const auto cube_of_one = cube(Coord(0), 8, 1.0f);
    CHECK(names_of(page_of(wish_for(), {frame_of(1, cube_of_one, nullptr)})) == Names{"before: maximum along y"});
    CHECK(names_of(page_of(wish_for(View::x, SheetWish::Show::slice), {frame_of(1, cube_of_one, cube_of_one)})) ==
          Names{"before: slice at x = 3", "after: slice at x = 3"});
    auto frame = frame_of(1, cube_of_one, nullptr);
    frame.energy = cube(Coord(0), 4, 1.0f);
    const auto page = page_of(wish_for(), {frame});
    CHECK(names_of(page) == Names{"before: maximum along y", "energy: slice at y = 3"});
    CHECK(page.summary == "1 of 1 frame");
}

TEST_CASE("slices are in the middle of what is shown, or where they are wanted") {
    const auto before = cube(Coord(0), 4, 1.0f);
    before->tree().setValueOn(Coord(0, 2, 0), 9.0f);
    auto wish = wish_for(View::y, SheetWish::Show::slice);
    auto page = page_of(wish, {frame_of(1, before, before), frame_of(2, cube(Coord(0, -6, 0), 4, 2.0f), before)});
    CHECK(page.rows[0].what == "slice at y = -2");
    CHECK(page.rows[0].panels[0].projection.empty());
    CHECK(page.rows[0].panels[0].note == "no active voxels");
    CHECK(page.rows[0].panels[1].projection.empty());
    wish.slice = 2;
    page = page_of(wish, {frame_of(1, before, before)});
    CHECK(page.rows[0].what == "slice at y = 2");
    CHECK(page.rows[0].panels[0].projection.at(0, 0) == 9.0f);
    CHECK(page.rows[0].panels[0].projection.at(1, 0) == 1.0f);
}

TEST_CASE("removed seams are drawn where they were before any of them was removed") {
    const auto lattice = row_lattice();
    const auto space = openvdb::math::Transform::createLinearTransform(1);
    // Index 3 four times over, in the space that the earlier ones leave: originally 3, 4, 5 and 6. Then 0, and then 0
    // again: 0 and 1.
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
    CHECK(rounded(crossings(seam_lines(lattice, straight(lattice, Seams::Kind::insert, {7, 2}), 1, *space, View::y, 5), 1.25)) == Doubles{3, 8});
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
    CHECK(rounded(crossings(seam_lines(lattice, seams, 1, *fine, View::z, 4), 2.5001)).front() == Approx(12.5).margin(1e-3));
}

TEST_CASE("seams are drawn over the energy in a colour of their own, and counted") {
    auto frame = frame_of(1, cube(Coord(0), 10, 1.0f), nullptr);
    const auto lattice = row_lattice();
    frame.energy = cube(Coord(0), 10, 1.0f);
    frame.lattice = std::make_shared<Lattice>(lattice);
    frame.seams = std::make_shared<Seams>(straight(lattice, Seams::Kind::remove, {3, 3}));
    auto wish = wish_for();
    wish.slice = 5;
    const auto page = page_of(wish, {frame});
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

    wish.slice = 7;
    CHECK(names_of(page_of(wish, {frame})).back() == "seams over energy: slice at y = 7; no seam crosses it");
    wish.view = View::x;
    CHECK(names_of(page_of(wish, {frame})).back() == "seams over energy: slice at x = 7; seams face this view, choose another axis");
}

TEST_CASE("seams of another lattice or without the frame shown are a failure") {
    const auto lattice = row_lattice();
    const auto seams = straight(lattice, Seams::Kind::remove, {3});
    CHECK(failure_of([&] { require_seams(lattice, seams, 7); }) == "the seams do not hold frame 7; they hold 1-3");
    const auto other = make_box({0, 6, 0}, {10, 1, 4}, 1, {0, 1, 2});
    CHECK(failure_of([&] { require_seams(other, seams, 1); }) ==
          "the seams were found in another lattice: theirs is a box of 10 x 1 x 4 vertices from (0, 5, 0) to (9, 5, 3), spacing 1, axes xyz (" + lattice.hash +
              "), this one a box of 10 x 1 x 4 vertices from (0, 6, 0) to (9, 6, 3), spacing 1, axes xyz (" + other.hash + ")");
}

TEST_CASE("a frame without active voxels has an empty panel, one without changes says so") {
    auto wish = wish_for();
    wish.difference = true;
    const auto filled = cube(Coord(0), 4, 1.0f);
    const auto page = page_of(wish, {frame_of(1, named("density"), filled), frame_of(2, filled, filled)});
    CHECK(page.rows[0].panels[0].note == "no active voxels");
    CHECK(page.rows[2].panels[0].note.empty());
    CHECK(page.rows[2].panels[1].note == "no difference");
    CHECK(draw_sheet(page_of(wish, {frame_of(1, named("density"), named("density"))})).height() < 600);
}

TEST_CASE("sheets stay within a screen's width, whatever the grid's size and the count of frames") {
    for (const int size : {1, 7, 44, 100, 3000})
        for (const int height : {1, size / 3, 2 * size})
            for (const int count : {1, 3, 7, 12}) {
                const auto grid = named("density");
                grid->tree().setValueOn(Coord(0), 1.0f);
                grid->tree().setValueOn(Coord(size - 1, 0, height), 1.0f);
                const auto sheet = draw_sheet(page_of(wish_for(), std::vector<SheetFrame>(static_cast<std::size_t>(count), frame_of(1, grid, grid))));
                INFO(count << " frames of " << size << " x " << height << ": " << sheet.width() << " x " << sheet.height());
                CHECK(sheet.width() >= 560);
                CHECK(sheet.width() <= 2000);
                CHECK(sheet.height() <= 3200);
            }
}

TEST_CASE("the frames shown are spread from the first to the last") {
    CHECK(shown_of("3", 16) == Places{0, 8, 15});
    CHECK(shown_of("3", 3) == Places{0, 1, 2});
    CHECK(shown_of("5", 2) == Places{0, 1});
    CHECK(shown_of("2", 84) == Places{0, 83});
    CHECK(shown_of("1", 9) == Places{4});
}

TEST_CASE("the sheet node writes one PNG after the last frame") {
    const Scratch scratch;
    NodeBench node(preview_sheet(), "{path: " + (scratch / "new/sheet.png") + ", frames: 2, difference: false}", {{"before", 1}, {"after", 1}});
    REQUIRE(node.faults() == "");
    const std::vector<int> frames{5, 6, 7};
    Context::Host host;
    Context context(host, frames);
    const auto before = cube(Coord(0), 8, 1.0f), after = cube(Coord(2), 8, 1.0f);
    for (std::size_t place = 0; place < frames.size(); ++place) node.add({{"before", {volume_of(before)}}, {"after", {volume_of(after)}}}, context.at(place));
    CHECK_FALSE(std::filesystem::exists(scratch / "new/sheet.png"));
    node.finish(context);

    const auto png = Scratch::read(scratch / "new/sheet.png");
    REQUIRE(png.size() > 1000);
    CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
    const auto number = [&](std::size_t at) {
        int out = 0;
        for (std::size_t n = 0; n < 4; ++n) out = out << 8 | static_cast<unsigned char>(png[at + n]);
        return out;
    };
    const auto expected = draw_sheet(page_of(wish_for(), {frame_of(5, before, after), frame_of(7, before, after)}));
    CHECK(number(16) == expected.width());
    CHECK(number(20) == expected.height());
    CHECK(std::distance(std::filesystem::directory_iterator(scratch / "new"), {}) == 1);
}

TEST_CASE("a volume that is the same in all frames is shown once, whichever frame is wanted") {
    const Scratch scratch;
    NodeBench node(preview_sheet(), "{path: " + (scratch / "sheet.png") + ", frames: 1}");
    const std::vector<int> frames{5, 6, 7};
    Context::Host host;
    const Context context(host, frames);
    node.add({{"before", {volume_of(cube(Coord(0), 8, 1.0f))}}}, context);
    node.finish(context);
    CHECK(std::filesystem::exists(scratch / "sheet.png"));
    CHECK(failure_of([&] { NodeBench(preview_sheet(), "{path: x.png}").finish(context); }) == "none of the frames to show has come");
}

TEST_CASE("inputs and parameters of a sheet that need each other say so") {
    const auto faults = [](const std::string& yaml, const std::map<std::string, std::size_t>& connected) {
        return NodeBench(preview_sheet(), yaml, connected).faults();
    };
    CHECK(faults("{}", {{"before", 1}, {"seams", 1}}) ==
          "seams: 'seams' are drawn over 'energy'; connect it too\n"
          "seams: 'seams' needs 'lattice', in which they were found\n");
    CHECK(faults("{}", {{"before", 1}, {"lattice", 1}}) == "lattice: 'lattice' is for 'seams'; connect them too\n");
    CHECK(faults("{difference: true}", {{"before", 1}}) == "difference: 'difference' is that of 'after', which is not connected\n");
    CHECK(faults("{slice: 3}", {{"before", 1}}) == "slice: nothing is sliced: 'slice' needs 'energy', or 'show: slice' or 'both'\n");
    CHECK(faults("{slice: -3, show: both}", {{"before", 1}}) == "");
    CHECK(faults("{slice: auto, show: maximum}", {{"before", 1}, {"energy", 1}, {"lattice", 1}, {"seams", 1}}) == "");
}

TEST_CASE("a grid that is not there or can't be shown is a failure that names what is") {
    const auto failure = [&](const std::string& grid, const Volume& before, const Volume& after) {
        return failure_of([&] {
            NodeBench(preview_sheet(), "{grid: " + grid + "}")
                .add({{"before", {Payload(std::make_shared<const Volume>(before))}}, {"after", {Payload(std::make_shared<const Volume>(after))}}});
        });
    };
    const Volume volume{{cube(Coord(0), 2, 1.0f)}, {}, {}};
    const auto mask = openvdb::MaskGrid::create();
    const auto vectors = VectorGrid::create();
    mask->setName("density");
    vectors->setName("density");
    CHECK(failure("densty", volume, volume) == "'before' has no grid 'densty'; did you mean 'density'?");
    CHECK(failure("density", volume, {{named("heat")}, {}, {}}) == "'after' has no grid 'density'; known: heat");
    CHECK(failure("density", {{mask}, {}, {}}, volume) == "grid 'density' of 'before' holds bool values; a sheet shows grids of floats or vectors");
    CHECK(failure("density", volume, {{vectors}, {}, {}}) == "grid 'density' holds float values in 'before', but vec3s in 'after'");
    CHECK(failure("density", volume, volume).empty());
}
