#include "nodes/preview/sheet.h"
#include "nodes/preview/sheet_rows.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"
#include "tests/support/sheets.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

using Names = std::vector<std::string>;

std::vector<std::size_t> shown_of(const std::string& count, int total) {
    const auto type = preview_sheet();
    const auto params = type.make_params();
    Problems problems;
    ValueReader reader(problems, "frames", type.param("frames")->range);
    type.param("frames")->parse(params.get(), Value::scalar({}, count), reader);
    std::vector<int> frames;
    for (int n = 0; n < total; ++n) frames.push_back(1001 + n);
    Context::Host host;
    Context context(host, frames);
    const auto takes = type.traits(params.get()).takes;
    std::vector<std::size_t> out;
    for (std::size_t t = 0; t < frames.size(); ++t)
        if (takes(context.at(t))) out.push_back(t);
    return out;
}

using Places = std::vector<std::size_t>;

Payload volume_with(const FloatGrid::Ptr& grid) {
    return Payload(std::make_shared<const Volume>(Volume{{grid}, {}, {}}));
}

}  // namespace

TEST_CASE("before and after share one range of colours and one window") {
    const auto strong = cube(Coord(0), 16, 4.0f);
    const auto weak = cube(Coord(16, 0, 8), 8, 2.0f);
    const auto sheet = draw_sheet(page_of(request_for(), {frame_of(1, strong, weak)}));
    const auto whole = find(sheet, heat(1));
    const auto half = find(sheet, heat(0.5));
    REQUIRE(whole.count > 0);
    REQUIRE(half.count > 0);
    // The window is 24 x 16 voxels: the weak cube has half the strong one's size and stands at its
    // upper right.
    CHECK(whole.bottom < half.top);
    CHECK((half.right - half.left) * 2 == Approx(whole.right - whole.left).margin(6));
    CHECK((half.bottom - half.top) * 2 == Approx(whole.bottom - whole.top).margin(6));
    CHECK(half.left == Approx(whole.right).margin(5));
    const auto turned = draw_sheet(page_of(request_for(), {frame_of(1, weak, strong)}));
    CHECK(find(turned, heat(0.5)).bottom < find(turned, heat(1)).top);
}

TEST_CASE("the range of values starts at 0, that of differences is the same on both sides") {
    auto request = request_for();
    request.difference = true;
    const auto page =
        page_of(request, {frame_of(1, cube(Coord(0), 4, 3.0f), cube(Coord(0), 4, 2.0f)),
                          frame_of(2, cube(Coord(0), 4, 3.0f), cube(Coord(0), 4, 3.5f))});
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
    auto request = request_for(View::y, {SheetRequest::Show::maximum, SheetRequest::Show::slice});
    request.difference = true;
    const auto page =
        page_of(request, {frame_of(1, cube(Coord(0), 8, 1.0f), cube(Coord(0), 8, 2.0f)),
                          frame_of(2, cube(Coord(0), 8, 3.0f), cube(Coord(0), 8, 4.0f))});
    CHECK(page.frames == Names{"frame 1", "frame 2"});
    CHECK(names_of(page) == Names{"before: maximum along y", "after: maximum along y",
                                  "difference: after - before, largest along y",
                                  "before: slice at y = 3", "after: slice at y = 3",
                                  "difference: after - before, slice at y = 3"});
    const auto sheet = draw_sheet(page);
    const auto before_1 = find(sheet, heat(0.25)), after_1 = find(sheet, heat(0.5)),
               before_2 = find(sheet, heat(0.75));
    REQUIRE(before_1.count > 0);
    CHECK(before_1.right < before_2.left);
    CHECK(before_1.top == before_2.top);
    CHECK(before_1.left == after_1.left);
    CHECK(before_1.top < after_1.top);
    CHECK(before_1.count == before_2.count);
}

TEST_CASE("rows whose inputs are missing or that are not wanted are left out") {
    const auto cube_of_one = cube(Coord(0), 8, 1.0f);
    CHECK(names_of(page_of(request_for(), {frame_of(1, cube_of_one, nullptr)})) ==
          Names{"shown: maximum along y"});
    CHECK(names_of(page_of(request_for(View::x, {SheetRequest::Show::slice}),
                           {frame_of(1, cube_of_one, cube_of_one)})) ==
          Names{"before: slice at x = 3", "after: slice at x = 3"});
    auto frame = frame_of(1, cube_of_one, nullptr);
    frame.energy = cube(Coord(0), 4, 1.0f);
    const auto page = page_of(request_for(), {frame});
    CHECK(names_of(page) == Names{"shown: maximum along y", "energy: slice at y = 3"});
    CHECK(page.summary == "1 of 1 frame");
}

TEST_CASE("slices are in the middle of what is shown, or where they are wanted") {
    const auto before = cube(Coord(0), 4, 1.0f);
    before->tree().setValueOn(Coord(0, 2, 0), 9.0f);
    auto request = request_for(View::y, {SheetRequest::Show::slice});
    auto page = page_of(request, {frame_of(1, before, before),
                                  frame_of(2, cube(Coord(0, -6, 0), 4, 2.0f), before)});
    CHECK(page.rows[0].what == "slice at y = -2");
    CHECK(page.rows[0].panels[0].projection.empty());
    CHECK(page.rows[0].panels[0].note == "no active voxels");
    CHECK(page.rows[0].panels[1].projection.empty());
    request.slice = 2;
    page = page_of(request, {frame_of(1, before, before)});
    CHECK(page.rows[0].what == "slice at y = 2");
    CHECK(page.rows[0].panels[0].projection.at(0, 0) == 9.0f);
    CHECK(page.rows[0].panels[0].projection.at(1, 0) == 1.0f);
}

TEST_CASE("a frame without active voxels has an empty panel, one without changes says so") {
    auto request = request_for();
    request.difference = true;
    const auto filled = cube(Coord(0), 4, 1.0f);
    const auto page =
        page_of(request, {frame_of(1, named("density"), filled), frame_of(2, filled, filled)});
    CHECK(page.rows[0].panels[0].note == "no active voxels");
    CHECK(page.rows[2].panels[0].note.empty());
    CHECK(page.rows[2].panels[1].note == "no difference");
    CHECK(draw_sheet(page_of(request, {frame_of(1, named("density"), named("density"))})).height() <
          600);
}

TEST_CASE("sheets stay within a screen's width, whatever the grid's size and the count of frames") {
    for (const int size : {1, 7, 44, 100, 3000})
        for (const int height : {1, size / 3, 2 * size})
            for (const int count : {1, 3, 7, 12}) {
                const auto grid = named("density");
                grid->tree().setValueOn(Coord(0), 1.0f);
                grid->tree().setValueOn(Coord(size - 1, 0, height), 1.0f);
                const auto sheet = draw_sheet(
                    page_of(request_for(), std::vector<SheetFrame>(static_cast<std::size_t>(count),
                                                                   frame_of(1, grid, grid))));
                INFO(count << " frames of " << size << " x " << height << ": " << sheet.width()
                           << " x " << sheet.height());
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
    NodeBench node(preview_sheet(),
                   "{path: " + (scratch / "new/sheet.png") + ", frames: 2, difference: false}",
                   {{"before", 1}, {"after", 1}});
    REQUIRE(node.faults() == "");
    const std::vector<int> frames{5, 6, 7};
    Context::Host host;
    Context context(host, frames);
    const auto before = cube(Coord(0), 8, 1.0f), after = cube(Coord(2), 8, 1.0f);
    for (std::size_t t = 0; t < frames.size(); ++t)
        node.add({{"before", {volume_with(before)}}, {"after", {volume_with(after)}}},
                 context.at(t));
    CHECK_FALSE(std::filesystem::exists(scratch / "new/sheet.png"));
    node.finish(context);

    const auto png = Scratch::read(scratch / "new/sheet.png");
    REQUIRE(png.size() > 1000);
    CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
    const auto number = [&](std::size_t at) {
        int out = 0;
        for (std::size_t n = 0; n < 4; ++n)
            out = out << 8 | static_cast<unsigned char>(png[at + n]);
        return out;
    };
    const auto expected = draw_sheet(
        page_of(request_for(), {frame_of(5, before, after), frame_of(7, before, after)}));
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
    node.add({{"before", {volume_with(cube(Coord(0), 8, 1.0f))}}}, context);
    node.finish(context);
    CHECK(std::filesystem::exists(scratch / "sheet.png"));
    CHECK(failure_of([&] { NodeBench(preview_sheet(), "{path: x.png}").finish(context); }) ==
          "none of the frames to show was computed");
}

TEST_CASE("inputs and parameters of a sheet that need each other say so") {
    const auto faults = [](const std::string& yaml,
                           const std::map<std::string, std::size_t>& connected) {
        return NodeBench(preview_sheet(), yaml, connected).faults();
    };
    CHECK(faults("{}", {{"before", 1}, {"seams", 1}}) ==
          "seams: 'seams' are drawn over 'energy'; connect it too\n"
          "seams: 'seams' needs 'lattice', in which they were found\n");
    CHECK(faults("{}", {{"before", 1}, {"lattice", 1}}) ==
          "lattice: 'lattice' is for 'seams', or to be drawn: connect 'seams', or state 'overlay: "
          "[lattice]'\n");
    CHECK(
        faults("{difference: true}", {{"before", 1}}) ==
        "difference: 'difference' compares 'before' with 'after', but 'after' is not connected\n");
    CHECK(faults("{slice: 3}", {{"before", 1}}) ==
          "slice: nothing is sliced: 'slice' needs a connected 'energy', 'show: slice' or 'show: "
          "both'\n");
    CHECK(faults("{slice: -3, show: both}", {{"before", 1}}) == "");
    CHECK(faults("{slice: auto, show: maximum}",
                 {{"before", 1}, {"energy", 1}, {"lattice", 1}, {"seams", 1}}) == "");

    CHECK(faults("{exposure: 1}", {{"before", 1}}) ==
          "exposure: 'exposure' is for renders; choose 'show: render', or leave it out\n");
    CHECK(faults("{exposure: 1, show: render}", {{"before", 1}}) == "");
    CHECK(faults("{overlay: [lattice, rig]}", {{"before", 1}, {"lattice", 1}}) ==
          "overlay: 'overlay' names 'rig', but the input 'rig' is not connected; connect it\n");
    CHECK(faults("{overlay: lattice}", {{"before", 1}, {"lattice", 1}}) == "");
    CHECK(faults("{overlay: []}", {{"before", 1}, {"energy", 1}, {"lattice", 1}, {"seams", 1}}) ==
          "");
    CHECK(faults("{}", {{"before", 1}, {"rig", 1}}) ==
          "rig: 'rig' is to be drawn: state 'overlay: [rig]', or leave 'rig' out\n");
    CHECK(faults("{path: s.jpg}", {{"before", 1}}) ==
          "path: 'path' must end in .png; a sheet is a PNG file\n");
    CHECK(faults("{path: S.PNG}", {{"before", 1}}) == "");
}

TEST_CASE("ways to show a grid are stated as one or as a list, each once") {
    const auto faults = [](const std::string& yaml) {
        return NodeBench(preview_sheet(), yaml, {{"before", 1}, {"after", 1}}).faults();
    };
    CHECK(faults("{show: [render, maximum], difference: true, slice: auto}") ==
          "slice: nothing is sliced: 'slice' needs a connected 'energy', 'show: slice' or 'show: "
          "both'\n");
    CHECK(faults("{show: [render, both], difference: true, slice: 3}") == "");
    CHECK(faults("{show: []}") ==
          "show: 'show' names nothing; name 'render', 'maximum' or 'slice'\n");
    CHECK(faults("{show: [both, slice]}") ==
          "show: 'show' names 'slice' twice; 'both' is 'maximum' and 'slice'\n");
    CHECK(faults("{show: rendr}") ==
          "show must be one of maximum, slice, both, render, not 'rendr'\n");
    CHECK(faults("{show: {a: 1}}") ==
          "show must be one of maximum, slice, both, render, or a list, each one of maximum, "
          "slice, both, render, not a map\n");
    CHECK(preview_sheet().param("show")->fallback == "maximum");
    const NodeBench several(preview_sheet(), "{show: [render, slice]}");
    CHECK(several.type().param("show")->text(several.params()) == "[render, slice]");
}

TEST_CASE("rows follow each other as the ways to show a grid do") {
    auto frame = frame_of(1, cube(Coord(0), 8, 1.0f), cube(Coord(0), 8, 0.5f));
    frame.before_scene.smoke = cube(Coord(0), 8, 1.0f);
    frame.after_scene.smoke = cube(Coord(0), 8, 0.5f);
    auto request = request_for(View::y, {SheetRequest::Show::render, SheetRequest::Show::maximum});
    request.difference = true;
    const auto page = page_of(request, {frame});
    CHECK(names_of(page) == Names{"before: lit, seen along y", "after: lit, seen along y",
                                  "before: maximum along y", "after: maximum along y",
                                  "difference: after - before, largest along y"});
    CHECK_FALSE(page.rows[0].panels[0].render.empty());
    CHECK_FALSE(page.rows[2].panels[0].projection.empty());
    request.shows = {SheetRequest::Show::slice, SheetRequest::Show::render};
    request.difference = false;
    const auto sliced = page_of(request, {frame});
    CHECK(names_of(sliced) == Names{"before: slice at y = 3", "after: slice at y = 3",
                                    "before: lit, seen along y", "after: lit, seen along y"});
    CHECK_FALSE(sliced.rows[1].panels[0].projection.empty());
    // The size stands in one of the rows.
    CHECK(sliced.rows[0].panels[0].caption.empty());
    CHECK(sliced.rows[2].panels[0].caption == "8 x 8 x 8 voxels");
}

TEST_CASE("the world's axes are drawn as they are seen") {
    const auto axes = [](View view, const openvdb::math::Transform::Ptr& space) {
        const auto grid = cube(Coord(0), 4, 1.0f);
        grid->setTransform(space);
        return page_of(request_for(view), {frame_of(1, grid, nullptr)}).axes;
    };
    const auto is = [](const SeenDirection& seen, double right, double up, double towards) {
        return seen.right == Approx(right).margin(1e-9) && seen.up == Approx(up).margin(1e-9) &&
               seen.towards == Approx(towards).margin(1e-9);
    };
    const auto plain = openvdb::math::Transform::createLinearTransform(0.1);
    auto seen = axes(View::x, plain);
    CHECK((is(seen[0], 0, 0, 1) && is(seen[1], 1, 0, 0) && is(seen[2], 0, 1, 0)));
    seen = axes(View::y, plain);
    CHECK((is(seen[0], 1, 0, 0) && is(seen[1], 0, 0, -1) && is(seen[2], 0, 1, 0)));
    seen = axes(View::z, plain);
    CHECK((is(seen[0], 1, 0, 0) && is(seen[1], 0, 1, 0) && is(seen[2], 0, 0, 1)));
    // Of a grid that is mirrored and stretched, and of one that is turned by 45 degrees.
    const auto mirrored = openvdb::math::Transform::createLinearTransform(
        openvdb::Mat4d(-1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1));
    seen = axes(View::y, mirrored);
    CHECK((is(seen[0], -1, 0, 0) && is(seen[2], 0, 1, 0)));
    const double half = std::sqrt(0.5);
    const auto turned = openvdb::math::Transform::createLinearTransform(
        openvdb::Mat4d(half, half, 0., 0., -half, half, 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.));
    seen = axes(View::z, turned);
    CHECK(seen[0].right == Approx(half));
    CHECK(std::abs(seen[0].up) == Approx(half));
    CHECK(is(seen[2], 0, 0, 1));

    const auto sheet =
        draw_sheet(page_of(request_for(View::y), {frame_of(1, cube(Coord(0), 4, 1.0f), nullptr)}));
    const auto x = find_in_head(sheet, axis_colours[0]), y = find_in_head(sheet, axis_colours[1]),
               z = find_in_head(sheet, axis_colours[2]);
    REQUIRE(x.count > 20);
    REQUIRE(y.count > 5);
    REQUIRE(z.count > 20);
    CHECK(x.right - x.left > x.bottom - x.top);
    CHECK(z.bottom - z.top > z.right - z.left);
    CHECK(x.right > z.right);
    CHECK(z.top < x.top);
    // `y` points away: a circle where the arrows begin.
    CHECK(y.right < x.right);
    CHECK(y.top > z.top);
}

TEST_CASE("a grid that no reader has is told before the run, for frames that are shown") {
    const auto told = [](const std::string& yaml,
                         const std::map<std::string, SurveyedFacts>& received) {
        return NodeBench(preview_sheet(), "{path: x.png, " + yaml + "}")
            .survey({5, 6, 7}, received)
            .absent;
    };
    using Told = std::map<int, std::string>;
    const SurveyedFacts one{Names{"density"}, std::nullopt},
        two{Names{"density", "velocity"}, std::nullopt}, unknown{};
    CHECK(told("grid: smoke", {{"before", two}, {"after", two}}) ==
          Told{{5, "'before' has no grid 'smoke'; known: density, velocity"}});
    CHECK(told("grid: smoke, frames: 1", {{"before", two}}) ==
          Told{{6, "'before' has no grid 'smoke'; known: density, velocity"}});
    CHECK(told("grid: velocity", {{"before", two}, {"after", one}}) ==
          Told{{5, "'after' has no grid 'velocity'; known: density"}});
    CHECK(told("grid: velocity", {{"before", two}, {"after", unknown}}).empty());
    CHECK(told("grid: smoke", {}).empty());
}

TEST_CASE("a grid that is not there or can't be shown is a failure that names what is") {
    const auto failure = [&](const std::string& grid, const Volume& before, const Volume& after) {
        return failure_of([&] {
            NodeBench(preview_sheet(), "{grid: " + grid + "}")
                .add({{"before", {Payload(std::make_shared<const Volume>(before))}},
                      {"after", {Payload(std::make_shared<const Volume>(after))}}});
        });
    };
    const Volume volume{{cube(Coord(0), 2, 1.0f)}, {}, {}};
    const auto mask = openvdb::MaskGrid::create();
    const auto vectors = VectorGrid::create();
    mask->setName("density");
    vectors->setName("density");
    CHECK(failure("densty", volume, volume) ==
          "'before' has no grid 'densty'; did you mean 'density'?");
    CHECK(failure("density", volume, {{named("heat")}, {}, {}}) ==
          "'after' has no grid 'density'; known: heat");
    CHECK(failure("density", {{mask}, {}, {}}, volume) ==
          "grid 'density' of 'before' holds bool values; a sheet shows grids of floats or vectors");
    CHECK(failure("density", volume, {{vectors}, {}, {}}) ==
          "grid 'density' holds float values in 'before', but vec3s in 'after'");
    CHECK(failure("density", volume, volume).empty());
}

TEST_CASE(
    "a sheet refuses grids that reach to the ends of index space, and tiles beyond the memory") {
    const auto far = named("density");
    far->tree().setValue(Coord(std::numeric_limits<int>::min(), 0, 0), 1.0f);
    far->tree().setValue(Coord(std::numeric_limits<int>::max(), 0, 0), 1.0f);
    for (const auto show :
         {SheetRequest::Show::maximum, SheetRequest::Show::slice, SheetRequest::Show::render}) {
        auto frame = frame_of(1, far, nullptr);
        if (show == SheetRequest::Show::render) frame.before_scene.smoke = far;
        CHECK_THAT(failure_of([&] { page_of(request_for(View::y, {show}), {frame}); }),
                   Catch::StartsWith("the active voxels of grid 'density' span [-2147483648, 0"));
    }

    const auto tile = named("density");
    tile->tree().root().addTile(Coord(0), 1.0f, true);
    auto request = request_for(View::y, {SheetRequest::Show::render});
    request.budget = 1'000'000'000;
    auto lit = frame_of(1, tile, nullptr);
    lit.before_scene.smoke = tile;
    CHECK_THAT(failure_of([&] { page_of(request, {lit}); }),
               Catch::Contains("as voxels these would take 275 GB"));
    request.shows = {SheetRequest::Show::maximum};
    request.difference = true;
    // A comparison takes a tile at once.
    CHECK(failure_of([&] { page_of(request, {frame_of(1, tile, named("density"))}); }).empty());
}
