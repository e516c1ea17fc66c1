#include "nodes/preview/render.h"
#include "nodes/preview/sheet.h"
#include "nodes/preview/sheet_rows.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"
#include "tests/support/sheets.h"

#include <tbb/global_control.h>

#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <limits>

using namespace fluidcarve;
using openvdb::tools::createLevelSetSphere;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

FloatGrid::Ptr block(const Coord& first, const Coord& last, float value,
                     const std::string& name = "density") {
    auto out = named(name);
    out->denseFill(CoordBBox(first, last), value, true);
    return out;
}

constexpr int radius = 9;

const CoordBBox around_ball(Coord(-radius - 2), Coord(radius + 2));

FloatGrid::Ptr ball(float value = 1) {
    auto out = named("density");
    for (auto at = CoordBBox(Coord(-radius), Coord(radius)).begin(); at; ++at)
        if ((*at).asVec3d().length() <= radius) out->tree().setValueOn(*at, value);
    return out;
}

constexpr Exposure one{1, 0};
constexpr Exposure with_fire{1, 1};

double light(const Colour& colour) {
    return (0.2126 * colour.red + 0.7152 * colour.green + 0.0722 * colour.blue) / 255;
}

/// The mean of a measure over the pixels of an area, given in voxels.
double mean(const RenderedPicture& render, const Area& area,
            const std::function<double(const Colour&)>& of) {
    const int pixels = render.picture.width / render.area.size(0);
    double sum = 0;
    int count = 0;
    for (int y = (render.area.last[1] - area.last[1]) * pixels;
         y < (render.area.last[1] - area.first[1] + 1) * pixels; ++y)
        for (int x = (area.first[0] - render.area.first[0]) * pixels;
             x < (area.last[0] - render.area.first[0] + 1) * pixels; ++x) {
            sum +=
                of(render.picture.pixels[static_cast<std::size_t>(y) * render.picture.width + x]);
            ++count;
        }
    return sum / count;
}

double brightness(const RenderedPicture& of, const Area& area) { return mean(of, area, light); }

double redness(const RenderedPicture& render, const Area& area) {
    return mean(render, area,
                [](const Colour& colour) { return (colour.red - colour.blue) / 255.0; });
}

bool plain(const RenderedPicture& render) {
    return std::ranges::all_of(render.picture.pixels,
                               [](const Colour& colour) { return colour == render_background; });
}

bool same(const RenderedPicture& a, const RenderedPicture& b) {
    return a.picture.width == b.picture.width && a.picture.pixels == b.picture.pixels;
}

/// What differs from the background, in voxels.
Area seen(const RenderedPicture& render) {
    const int pixels = render.picture.width / render.area.size(0);
    Area out;
    for (int y = 0; y < render.picture.height; ++y)
        for (int x = 0; x < render.picture.width; ++x) {
            if (render.picture.pixels[static_cast<std::size_t>(y) * render.picture.width + x] ==
                render_background)
                continue;
            const std::array<int, 2> voxel{render.area.first[0] + x / pixels,
                                           render.area.last[1] - y / pixels};
            out.include({voxel, voxel});
        }
    return out;
}

SheetFrame lit_frame(int number, const FloatGrid::ConstPtr& before,
                     const FloatGrid::ConstPtr& after) {
    SheetFrame out;
    out.name = "frame " + std::to_string(number);
    out.number = number;
    out.before = before;
    out.after = after;
    out.before_scene.smoke = before;
    out.after_scene.smoke = after;
    return out;
}

SheetRequest render_wish(View view = View::y) {
    SheetRequest out;
    out.grid = "density";
    out.view = view;
    out.shows = {SheetRequest::Show::render};
    return out;
}

Payload volume_of(const std::vector<openvdb::GridBase::ConstPtr>& grids) {
    return Payload(std::make_shared<const Volume>(Volume{{grids.begin(), grids.end()}, {}, {}}));
}

}  // namespace

TEST_CASE("preview render: the side towards the light is brighter than the one in shadow") {
    for (const auto view : {View::x, View::y, View::z}) {
        const auto shown = render({ball(), nullptr, {}}, view, around_ball, one);
        const double lit = brightness(shown, {{-6, 3}, {-3, 6}});
        const double shadow = brightness(shown, {{3, -6}, {6, -3}});
        INFO("view " << static_cast<int>(view));
        CHECK(lit > shadow + 0.2);
        CHECK(lit > light(render_background) + 0.2);
        CHECK(shadow < light(render_background));
        CHECK(brightness(shown, {{-6, -6}, {-3, -3}}) > shadow);
        CHECK(brightness(shown, {{3, 3}, {6, 6}}) > shadow);
    }
}

TEST_CASE("preview render: smoke throws its shadow on other smoke") {
    // A wall, and a block that stands between it and the light.
    const auto wall = block(Coord(0, 12, 0), Coord(31, 15, 31), 1);
    const auto both = wall->deepCopy();
    both->denseFill(CoordBBox(Coord(4, 4, 20), Coord(9, 9, 25)), 1, true);
    const CoordBBox box(Coord(0), Coord(31, 15, 31));
    const Area below{{12, 14}, {15, 17}};
    const auto alone = render({wall, nullptr, {}}, View::y, box, one);
    CHECK(brightness(render({both, nullptr, {}}, View::y, box, one), below) <
          brightness(alone, below) - 0.05);
}

TEST_CASE("preview render: a picture has the place and orientation of a projection") {
    const CoordBBox box(Coord(-20, -10, 3), Coord(19, 19, 42));
    const CoordBBox part(Coord(-16, 8, 30), Coord(-11, 15, 37));
    const auto grid = block(part.min(), part.max(), 1);
    for (const auto view : {View::x, View::y, View::z}) {
        const auto shown = render({grid, nullptr, {}}, view, box, one);
        INFO("view " << static_cast<int>(view));
        CHECK(shown.area.first == face_of(box, view).first);
        CHECK(shown.area.last == face_of(box, view).last);
        CHECK(shown.picture.width == 2 * shown.area.size(0));
        CHECK(shown.picture.height == 2 * shown.area.size(1));
        // Interpolation makes the smoke reach half a voxel further.
        const auto found = seen(shown);
        const auto face = face_of(part, view);
        for (const int side : {0, 1}) {
            CHECK(found.first[side] == face.first[side] - 1);
            CHECK(found.last[side] == face.last[side] + 1);
        }
    }
}

TEST_CASE("preview render: of two things the camera sees the nearer one") {
    const CoordBBox box(Coord(0), Coord(15));
    const auto burning = [&](const Coord& fire, const Coord& smoke) {
        return Scene{
            block(smoke, smoke.offsetBy(5), 1), block(fire, fire.offsetBy(5), 0.2f, "flame"), {}};
    };
    const Area middle{{7, 7}, {8, 8}};
    const auto ends = [](int axis, int at) {
        Coord out(5);
        out[axis] = at;
        return out;
    };
    // Seen from +x, -y and +z.
    for (const auto& [view, near, far] :
         {std::tuple{View::x, 10, 0}, {View::y, 0, 10}, {View::z, 10, 0}}) {
        const int axis = static_cast<int>(view);
        INFO("view " << axis);
        CHECK(redness(render(burning(ends(axis, near), ends(axis, far)), view, box, with_fire),
                      middle) > 0.4);
        CHECK(redness(render(burning(ends(axis, far), ends(axis, near)), view, box, with_fire),
                      middle) < 0.2);
    }
}

TEST_CASE(
    "preview render: fire glows where it is, the hotter the brighter, and lights the smoke around "
    "it") {
    const CoordBBox box(Coord(0), Coord(31));
    const auto flame = block(Coord(20, 14, 4), Coord(27, 17, 11), 0.5f, "flame");
    const auto fire = render({nullptr, flame, {}}, View::y, box, with_fire);
    const Area within{{22, 6}, {25, 9}}, beside{{4, 20}, {11, 27}};
    CHECK(redness(fire, within) > 0.3);
    CHECK(brightness(fire, within) > light(render_background) + 0.1);
    CHECK(brightness(fire, beside) == Approx(light(render_background)));
    const auto weak =
        render({nullptr, block(Coord(20, 14, 4), Coord(27, 17, 11), 0.25f, "flame"), {}}, View::y,
               box, with_fire);
    CHECK(brightness(weak, within) < brightness(fire, within) - 0.1);

    const auto smoke = block(Coord(4, 14, 4), Coord(31, 17, 11), 0.2f);
    const auto burning = render({smoke, flame, {}}, View::y, box, with_fire);
    CHECK(redness(burning, within) > 0.3);
    CHECK(redness(burning, {{17, 6}, {18, 9}}) > redness(burning, {{5, 6}, {8, 9}}) + 0.02);
}

TEST_CASE(
    "preview render: each stop of exposure makes smoke and fire brighter, and leaves the "
    "background") {
    const Area middle{{-3, -3}, {3, 3}};
    const auto fire = block(Coord(-4, -2, -4), Coord(4, 1, 4), 0.2f, "flame");
    for (const auto& scene : {Scene{ball(), nullptr, {}}, Scene{nullptr, fire, {}}}) {
        const auto of = [&](double gain) {
            return render(scene, View::y, around_ball, {1, 1, gain});
        };
        const auto plain_one = of(1), brighter = of(4), darker = of(0.25);
        CHECK(brightness(brighter, middle) > brightness(plain_one, middle) + 0.05);
        CHECK(brightness(darker, middle) < brightness(plain_one, middle) - 0.05);
        for (const auto* shown : {&plain_one, &brighter, &darker})
            CHECK(shown->picture.pixels.front() == render_background);
    }
    auto request = render_wish();
    const auto page = [&] { return page_of(request, {lit_frame(1, ball(), nullptr)}); };
    const auto before = page();
    CHECK(names_of(before) == std::vector<std::string>{"shown: lit, seen along y"});
    request.exposure = 1.5;
    const auto after = page();
    CHECK(names_of(after) == std::vector<std::string>{"shown: lit, seen along y, exposure +1.5"});
    CHECK(brightness(after.rows[0].panels[0].render, middle) >
          brightness(before.rows[0].panels[0].render, middle) + 0.05);
}

TEST_CASE("preview render: nothing to see is the plain background") {
    const CoordBBox box(Coord(0), Coord(9));
    CHECK(plain(render({}, View::y, box, one)));
    CHECK(plain(render({named("density"), named("flame"), {}}, View::y, box, with_fire)));
    CHECK(plain(render({block(Coord(0), Coord(5), 0), nullptr, {}}, View::y, box, one)));
    CHECK(plain(render({block(Coord(0), Coord(5), 1), nullptr, {}}, View::y, box, {0, 0})));
    CHECK_FALSE(plain(render({block(Coord(0), Coord(5), 1), nullptr, {}}, View::y, box, one)));
}

TEST_CASE("preview render: what is inactive, negative or no number is not seen") {
    const auto clean = ball();
    const auto odd = ball();
    odd->tree().setValueOn(Coord(-10, 0, 0), std::numeric_limits<float>::quiet_NaN());
    odd->tree().setValueOn(Coord(10, 0, 0), std::numeric_limits<float>::infinity());
    odd->tree().setValueOn(Coord(0, 0, 10), -5.0f);
    odd->tree().setValueOff(Coord(0, 0, -10), 7.0f);
    Exposure exposure;
    exposure.meter({odd, nullptr, {}});
    CHECK(exposure.smoke == 1);
    CHECK(same(render({odd, nullptr, {}}, View::y, around_ball, exposure),
               render({clean, nullptr, {}}, View::y, around_ball, one)));

    const auto full = FloatGrid::create(3.0f);
    full->setName("density");
    CHECK(plain(render({full, nullptr, {}}, View::y, around_ball, one)));
}

TEST_CASE("preview render: tiles are seen as voxels are") {
    const CoordBBox box(Coord(0), Coord(15));
    const auto tiles = named("density");
    tiles->sparseFill(box, 0.1f, true);
    REQUIRE(tiles->tree().activeTileCount() > 0);
    CHECK(same(render({tiles, nullptr, {}}, View::y, box, one),
               render({block(box.min(), box.max(), 0.1f), nullptr, {}}, View::y, box, one)));
}

TEST_CASE(
    "preview render: the exposure is relative, whatever the values' unit and the grid's "
    "transform") {
    const auto expected = render({ball(), nullptr, {}}, View::y, around_ball, one);
    CHECK(same(render({ball(256), nullptr, {}}, View::y, around_ball, {256, 0}), expected));
    CHECK_FALSE(same(render({ball(0.1f), nullptr, {}}, View::y, around_ball, one), expected));
    const auto flat = ball();
    const auto stretched = openvdb::math::Transform::createLinearTransform(0.1);
    stretched->preScale(openvdb::Vec3d(1, 2, 3));
    flat->setTransform(stretched);
    CHECK(same(render({flat, nullptr, {}}, View::y, around_ball, one), expected));
    flat->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 2));
    CHECK(same(render({flat, nullptr, {}}, View::y, around_ball, one), expected));
}

TEST_CASE("preview render: large boxes are seen through fewer pixels") {
    const auto size_of = [](int size) {
        const auto shown = render({}, View::y, CoordBBox(Coord(-3), Coord(size - 4)), one);
        REQUIRE(shown.picture.pixels.size() ==
                static_cast<std::size_t>(shown.picture.width) * shown.picture.height);
        return std::pair{shown.picture.width, shown.area.size(0)};
    };
    CHECK(size_of(1) == std::pair{2, 1});
    CHECK(size_of(100) == std::pair{200, 100});
    CHECK(size_of(150) == std::pair{300, 150});
    CHECK(size_of(399) == std::pair{399, 399});
    // Cells of four voxels, whole ones.
    CHECK(size_of(1500) == std::pair{376, 1504});
}

TEST_CASE("preview render: the same picture on one thread and on two") {
    const auto fire = block(Coord(-4, -12, -8), Coord(4, -9, 0), 1, "flame");
    const auto on = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return render({ball(), fire, {}}, View::y, around_ball, with_fire);
    };
    const auto alone = on(1);
    CHECK(same(on(2), alone));
    CHECK(same(on(4), alone));
}

TEST_CASE("preview render: flame comes with the smoke, density with the fire") {
    const auto density = named("density"), flame = named("flame"), heat = named("heat"),
               soot = named("soot");
    const Volume all{{density, flame, heat, soot}, {}, {}};
    const auto scene = [&](const openvdb::GridBase::ConstPtr& shown) {
        return scene_of(all, "before", shown);
    };
    CHECK(scene(density).smoke == density);
    CHECK(scene(density).fire == flame);
    CHECK(scene(soot).smoke == soot);
    CHECK(scene(soot).fire == flame);
    CHECK(scene(flame).smoke == density);
    CHECK(scene(flame).fire == flame);
    CHECK(scene(heat).smoke == density);
    CHECK(scene(heat).fire == heat);
    const Volume few{{soot, openvdb::MaskGrid::create()}, {}, {}};
    CHECK(scene_of(few, "before", soot).fire == nullptr);
    const auto coarse = named("flame");
    coarse->setTransform(openvdb::math::Transform::createLinearTransform(2));
    const auto left = scene_of({{density, coarse}, {}, {}}, "before", density);
    CHECK(left.fire == nullptr);
    CHECK(left.left_out == "flame");
}

TEST_CASE("preview render: a level set is water, whose slopes towards the light are brighter") {
    const auto shown = [](float voxel) {
        const auto ball = createLevelSetSphere<FloatGrid>(9 * voxel, openvdb::Vec3f(0), voxel);
        return render(scene_of({{ball}, {}, {}}, "before", ball), View::y,
                      CoordBBox(Coord(-12), Coord(11)), {});
    };
    const double calm = brightness(shown(1), {{-1, -1}, {1, 1}});
    CHECK(brightness(shown(1), {{-6, 3}, {-4, 5}}) > 2 * brightness(shown(1), {{4, -5}, {6, -3}}));
    CHECK(brightness(shown(1), {{-12, -12}, {-9, -9}}) == Approx(light(render_background)));
    CHECK(brightness(shown(10), {{-1, -1}, {1, 1}}) == Approx(calm).epsilon(1e-3));
}

TEST_CASE("preview render: before and after share one window and the exposure of before") {
    const auto strong = ball(4), weak = ball(1);
    const auto pictures = [&](const FloatGrid::Ptr& before, const FloatGrid::Ptr& after) {
        SheetRows rows(render_wish());
        rows.add(lit_frame(1, before, after));
        rows.add(lit_frame(2, weak, weak));
        const auto page = rows.page(2);
        REQUIRE(page.rows.size() == 2);
        std::vector<RenderedPicture> out;
        for (const auto& row : page.rows)
            for (const auto& panel : row.panels) out.push_back(panel.render);
        return out;
    };
    const auto equal = pictures(strong, strong);
    CHECK(same(equal[0], equal[2]));
    CHECK(same(equal[1], equal[3]));
    CHECK_FALSE(same(equal[0], equal[1]));
    // What is stronger after than before is seen as stronger, and changes nothing in the other
    // pictures.
    const auto raised = pictures(weak, strong);
    CHECK(same(raised[0], raised[1]));
    CHECK_FALSE(same(raised[2], raised[0]));
    CHECK(same(raised[0], pictures(weak, weak)[0]));

    const auto small = block(Coord(0), Coord(3), 4);
    const auto moved = pictures(small, strong);
    CHECK(moved[0].area.first == moved[2].area.first);
    CHECK(moved[0].area.last == moved[2].area.last);
    CHECK(seen(moved[0]).first == std::array{-1, -1});
    CHECK(seen(moved[0]).last == std::array{4, 4});
}

TEST_CASE("preview render: rows are before and after, then the energy as a slice") {
    auto frame = lit_frame(1, ball(), ball());
    frame.energy = block(Coord(0), Coord(3), 1);
    for (const bool stated : {false, true}) {
        auto request = render_wish();
        if (stated) request.slice = 2;
        SheetRows rows(request);
        rows.add(frame);
        std::vector<double> progress;
        const auto page = rows.page(1, [&](double fraction) { progress.push_back(fraction); });
        std::vector<std::string> names;
        for (const auto& row : page.rows) names.push_back(row.name + ": " + row.what);
        CHECK(names == std::vector<std::string>{
                           "before: lit, seen along y", "after: lit, seen along y",
                           stated ? "energy: slice at y = 2" : "energy: slice at y = 0"});
        CHECK(progress.size() == 2);
        CHECK(progress[0] < progress[1]);
        CHECK(page.rows[0].panels[0].caption == "19 x 19 x 19 voxels");
        CHECK(page.rows[1].panels[0].before.size(0) == 19);
        CHECK_FALSE(page.rows[2].panels[0].projection.empty());
        const auto sheet = draw_sheet(page);
        int smoke = 0, behind = 0;
        for (int y = 92; y < sheet.height(); ++y)
            for (int x = 246; x < sheet.width(); ++x) {
                const auto colour = sheet.at(x, y);
                behind += colour == render_background;
                smoke +=
                    colour.red > 150 && colour.red == colour.green && colour.green == colour.blue;
            }
        CHECK(behind > 1000);
        CHECK(smoke > 1000);
    }
}

TEST_CASE("preview render: grids are let go with the page, and an empty frame says so") {
    auto before = ball();
    const std::weak_ptr<const FloatGrid> held = before;
    SheetRows rows(render_wish());
    rows.add(lit_frame(1, before, nullptr));
    rows.add(lit_frame(2, named("density"), nullptr));
    before = nullptr;
    CHECK_FALSE(held.expired());
    const auto page = rows.page(2);
    CHECK(held.expired());
    CHECK(page.rows[0].panels[0].note.empty());
    CHECK(page.rows[0].panels[1].note == "no active voxels");
    CHECK(page.rows[0].panels[1].render.empty());
    SheetRows nothing(render_wish());
    nothing.add(lit_frame(1, named("density"), named("density")));
    CHECK(draw_sheet(nothing.page(1)).height() < 600);
}

TEST_CASE("preview render: grids that hold no floats are refused") {
    const auto vectors = VectorGrid::create();
    vectors->setName("velocity");
    const auto failure = [&](const std::string& show) {
        return failure_of([&] {
            NodeBench(preview_sheet(), "{path: x.png, grid: velocity, show: " + show + "}")
                .add({{"before", {volume_of({vectors})}}});
        });
    };
    CHECK(failure("render") ==
          "grid 'velocity' of 'before' holds vec3s values; 'show: render' needs floats: name "
          "another grid, or choose 'show: maximum'");
    CHECK(failure("maximum").empty());
}

TEST_CASE("preview render: a grid of another transform is left out with a warning") {
    struct Listener : Context::Host {
        std::vector<std::string> warnings;
        void warn(const std::string& message) override { warnings.push_back(message); }
    } listener;
    const std::vector<int> frames{1};
    const auto flame = block(Coord(0), Coord(3), 1, "flame");
    flame->setTransform(openvdb::math::Transform::createLinearTransform(2));
    NodeBench node(preview_sheet(), "{path: x.png, show: render}");
    node.add({{"before", {volume_of({ball(), flame})}}}, Context(listener, frames));
    CHECK(listener.warnings ==
          std::vector<std::string>{
              "'flame' of 'before' is not rendered: it has another transform than 'density'"});
}

TEST_CASE("preview render: parameters that a render has no use for say so") {
    const auto faults = [](const std::string& yaml,
                           const std::map<std::string, std::size_t>& connected) {
        return NodeBench(preview_sheet(), yaml, connected).faults();
    };
    CHECK(faults("{show: render, difference: true}", {{"before", 1}, {"after", 1}}) ==
          "difference: 'show: render' has no difference; leave 'difference' out, or choose 'show: "
          "maximum'\n");
    CHECK(faults("{show: render, difference: false}", {{"before", 1}, {"after", 1}}) == "");
    CHECK(faults("{show: render, slice: 3}", {{"before", 1}}) ==
          "slice: nothing is sliced: 'slice' needs a connected 'energy', 'show: slice' or 'show: "
          "both'\n");
    CHECK(faults("{show: render, slice: 3}", {{"before", 1}, {"energy", 1}}) == "");
}

TEST_CASE("preview render: fire grows lighter with its heat") {
    double last = -1;
    for (int n = 0; n <= 100; ++n) {
        const auto colour = flame(n / 100.0);
        CHECK(light(colour) >= last);
        CHECK(colour.red >= colour.green);
        CHECK(colour.green >= colour.blue);
        last = light(colour);
    }
    CHECK(flame(0) == Colour{});
    CHECK(flame(-1) == flame(0));
    CHECK(flame(2) == flame(1));
    CHECK(flame(std::numeric_limits<double>::quiet_NaN()) == flame(0));
}
