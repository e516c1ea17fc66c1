#include "carve/field/extent.h"
#include "carve/lattice/folds.h"
#include "nodes/page/page_grid.h"
#include "nodes/page/page_html.h"
#include "nodes/page/page_node.h"
#include "nodes/page/page_scene.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/browser.h"
#include "tests/support/node_bench.h"
#include "tests/support/page_frames.h"
#include "tests/support/wavy_seams.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// A lattice around a circle that reaches past its centre.
Lattice folded() { return ring({8, 8, 4}, {16, 6, 24}, 1, {-10, 0}); }

}  // namespace

TEST_CASE(
    "page voxels are means of cubes, and grids of other transforms are read at their centres") {
    FloatGrid fine, coarse;
    coarse.setTransform(openvdb::math::Transform::createLinearTransform(2));
    for (int n = 0; n < 8; ++n) fine.tree().setValue(Coord(n, 0, 0), static_cast<float>(n));
    coarse.tree().setValue(Coord(1, 0, 0), 8);
    const auto page = page_grid(fine.transformPtr(), {Coord(0), Coord(6, 0, 0)}, 4);
    CHECK(page.step == 2);
    CHECK(page.size == std::array<int, 3>{4, 1, 1});
    const auto means = page_values(fine, page);
    CHECK(means[1] == Approx((2 + 3) / 8.0));
    CHECK(means[3] == Approx((6 + 7) / 8.0));
    // Centres stand at 0.5, 2.5, ... along x and 0.5 along y and z.
    CHECK(page_values(coarse, page)[1] == Approx(8 * 0.75 * 0.75 * 0.75));
    CHECK(page.place(page.world({2, 0, 0})) == Vec3d(2, 0, 0));
    CHECK(page_bytes(std::vector<float>{-1, 0, 1, 2, 5}, 0, 2) ==
          std::vector<std::uint8_t>{0, 0, 128, 255, 255});
    CHECK(page_bytes(std::vector<float>{0, 2}, 2, 0) == std::vector<std::uint8_t>{255, 0});
    MaskGrid mask;
    mask.tree().setValueOn(Coord(3, 1, 1));
    CHECK(page_mask(mask, page_grid(fine.transformPtr(), {Coord(0), Coord(7, 1, 1)},
                                    8))[3 + 8 * 3] == 255);
}

TEST_CASE("page voxels are means of leaves and tiles alike, however far apart these lie") {
    const auto grid = FloatGrid::create(0.5f);
    grid->tree().addTile(1, {8, 0, 0}, 2, true);
    grid->tree().addTile(2, {-128, 0, 0}, 3, false);
    for (int n = 0; n < 200; ++n)
        grid->tree().setValue(Coord(n % 13 - 4, n % 7, n % 5), static_cast<float>(n));
    for (const int voxels : {40, 17, 3}) {
        const auto page =
            page_grid(grid->transformPtr(), {Coord(-9, -1, -2), Coord(20, 9, 11)}, voxels);
        const auto means = page_values(*grid, page);
        std::size_t n = 0;
        for (int z = 0; z < page.size[2]; ++z)
            for (int y = 0; y < page.size[1]; ++y)
                for (int x = 0; x < page.size[0]; ++x) {
                    const auto low =
                        page.first + Coord(x * page.step, y * page.step, z * page.step);
                    double sum = 0;
                    for (const auto& at : openvdb::CoordBBox(low, low.offsetBy(page.step - 1)))
                        sum += grid->tree().getValue(at);
                    CHECK(means[n++] == Approx(sum / std::pow(page.step, 3)));
                }
    }
    grid->tree().setValue(Coord(1'000'000, 2'000'000, 3'000'000), 1);
    const auto page = page_grid(grid->transformPtr(), active_box(*grid), 64);
    CHECK(page_values(*grid, page).size() == page.count());
}

TEST_CASE("a page loads nothing else, and no text of a pipeline ends its data") {
    const auto page = page_of(frame_of(12, 6));
    for (const auto* const outside : {"http:", "https:", "src=", "<link", "@import", "{{"})
        CHECK_FALSE(contains(page, outside));
    CHECK(contains(page, "default-src 'none'"));
    CHECK(contains(page, "shot.yaml &lt;/script&gt;"));
    CHECK(contains(page, "shot.yaml \\u003c/script>"));
    CHECK(page_of(frame_of(12, 6)) == page);
}

TEST_CASE("the page node says what is wrong with its parameters") {
    const auto faults = [](const std::string& yaml,
                           const std::map<std::string, std::size_t>& connected) {
        return NodeBench(preview_page(), yaml, connected).faults();
    };
    CHECK(faults("path: a.html", {{"before", 1}, {"seams", 1}, {"lattice", 1}}).empty());
    CHECK_THAT(faults("path: a.png", {{"before", 1}}), Catch::Contains("must end in .html"));
    CHECK_THAT(faults("path: a.html", {{"before", 1}, {"seams", 1}}),
               Catch::Contains("connect 'lattice'"));
    CHECK_THAT(faults("{path: a.html, rim_fade: 4}", {{"before", 1}}), Catch::Contains("fade"));
}

TEST_CASE("the page node shows the first grid that can be shown, and writes its file") {
    const Scratch scratch;
    const auto frame = frame_of(12, 6);
    NodeBench bench(preview_page(), "{path: " + (scratch / "new/page.html") + ", count: -4}",
                    {{"before", 1}, {"seams", 1}, {"lattice", 1}});
    const auto ids = openvdb::Int32Grid::create();
    ids->setName("ids");
    const Volume volume{{ids, frame.before}, {}, {}};
    bench.add({{"before", {Payload(std::make_shared<const Volume>(volume))}},
               {"lattice", {Payload(frame.lattice)}},
               {"seams", {Payload(frame.seams[0])}}});
    bench.finish();
    const auto page = Scratch::read(scratch / "new/page.html");
    CHECK(contains(page, "\"grid\":\"density\""));
    CHECK(contains(page, "\"count\":4"));

    NodeBench empty(preview_page(), "path: " + (scratch / "page.html"), {{"before", 1}});
    CHECK_THROWS_WITH(
        empty.add({{"before", {Payload(std::make_shared<const Volume>(Volume{{ids}, {}, {}}))}}}),
        Catch::Contains("it has: ids"));
    NodeBench other(preview_page(), "{grid: smoke, path: " + (scratch / "page.html") + "}",
                    {{"before", 1}});
    CHECK_THROWS_WITH(other.add({{"before", {Payload(std::make_shared<const Volume>(volume))}}}),
                      Catch::Contains("no grid 'smoke'"));
}

TEST_CASE("a page takes a grid by its name or by its number among equal names, before a run, too") {
    const auto absent = [](const std::string& grid) {
        return NodeBench(preview_page(), "{path: x.html, grid: " + grid + "}", {{"before", 1}})
            .survey({5}, {{"before", {{{"density", "density"}}, std::nullopt}}})
            .absent;
    };
    CHECK(absent("density").empty());
    CHECK(absent("'density[1]'").empty());
    CHECK(absent("'density[2]'").size() == 1);
}

TEST_CASE("the page needs no mouse, asks for no file, and says what to type",
          "[nightly][browser]") {
    if (!browser_is_there()) return;
    const Scratch scratch;
    const auto seen = ask_browser(scratch, page_of(frame_of(16, 6)), R"js(
        await showFrame();
        const key = (target, key) => target.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true, cancelable: true}));
        const controls = [...document.querySelectorAll('input, button, textarea, .view')].filter(each => each.offsetParent && !each.disabled);
        const out = {
            unnamed: controls.filter(each => !each.matches('.view') && !each.labels?.length && !each.ariaLabel && !each.textContent).map(each => each.id),
            unreached: controls.filter(each => each.tabIndex < 0).map(each => each.id),
            loaded: performance.getEntriesByType('resource').length, text: [byId('setting').value], knee: scenes[0].knee(),
            spoken: byId('count').ariaValueText};
        key(document.body, ']');
        out.text.push(byId('setting').value);
        key(document.body, '[');
        key(document.body, '[');
        out.text.push(byId('setting').value);
        const {yaw, zoom} = turn;
        key(views[0].area, 'ArrowLeft');
        key(views[0].area, '+');
        out.turned = [turn.yaw !== yaw, turn.zoom > zoom];
        key(views[0].area, 'Home');
        out.home = turn.yaw === yaw && turn.zoom === zoom;
        out.views = [...document.querySelectorAll('input[name=kind]')].filter(each => !each.disabled).length;
        return out;)js");
    CHECK(seen["unnamed"].empty());
    CHECK(seen["unreached"].empty());
    CHECK(seen["loaded"] == 0);
    CHECK(seen["text"] ==
          nlohmann::json{"--set seams.count=-5", "--set seams.count=-6", "--set seams.count=-4"});
    CHECK(seen["spoken"] == "-5 seams");
    CHECK(seen["knee"] == 4);
    CHECK(seen["turned"] == nlohmann::json{true, true});
    CHECK(seen["home"] == true);
    CHECK(seen["views"] == 4);
}

TEST_CASE(
    "a volume is drawn, lit by WebGL2, and again after its context is lost, and without WebGL2 "
    "there are slices",
    "[nightly][browser]") {
    if (!browser_is_there()) return;
    const Scratch scratch;
    const auto page = page_of(frame_of(16, 6));
    const std::string look = R"js(
        const seen = () => {
            draw();
            const {gl} = volume, {width, height} = byId('volume'), all = new Uint8Array(4 * width * height);
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, all);
            return [all[4 * (5 + width * 5)], all[4 * ((width >> 2) + width * (height >> 1))], all[4 * ((width >> 1) + width * (height >> 1))]];
        };
        await showFrame();)js";
    const auto drawn = ask_browser(scratch, page, look + R"js(
        const first = seen(), lose = volume.gl.getExtension('WEBGL_lose_context');
        const event = name => new Promise(done => byId('volume').addEventListener(name, () => setTimeout(done, 50)));
        const lost = event('webglcontextlost');
        lose.loseContext();
        await lost;
        const restored = event('webglcontextrestored');
        lose.restoreContext();
        await restored;
        return {first, again: seen()};)js");
    // The corner is empty, the middle is not.
    CHECK(std::abs(drawn["first"][2].get<int>() - drawn["first"][0].get<int>()) > 20);
    CHECK(drawn["again"] == drawn["first"]);
    const auto flat = ask_browser(scratch, page, R"js(
        await showFrame();
        draw();
        const {picture} = views[0], {width, height} = picture.canvas, pixels = picture.context.getImageData(0, 0, width, height).data;
        return {kind: kind(), volume: volume !== null, enabled: document.querySelector('input[value=volume]').disabled,
            middle: pixels[4 * ((width >> 1) - 8 + width * (height >> 1))], notes: byId('notes').textContent};)js",
                                  "--disable-3d-apis");
    CHECK(flat["volume"] == false);
    CHECK(flat["enabled"] == true);
    CHECK(flat["kind"] == "y");
    CHECK(flat["middle"].get<int>() > 100);
    CHECK(contains(flat["notes"], "no WebGL2"));
}

TEST_CASE("before there are seams, the page shows the lattice and tells of cells that fold",
          "[nightly][browser]") {
    if (!browser_is_there()) return;
    const Scratch scratch;
    PageFrame frame = frame_of(16, 0);
    frame.lattice = std::make_shared<Lattice>(folded());
    const auto seen = ask_browser(scratch, page_of(frame), R"js(
        await showFrame();
        return {folds: views[0].frame.folds.length, lattice: overlays().has('lattice'), slider: byId('count').offsetParent !== null,
            notes: byId('notes').textContent};)js");
    CHECK(seen["folds"] == static_cast<int>(count_folds(*frame.lattice, 16, 6).cells));
    CHECK(seen["folds"].get<int>() > 0);
    CHECK(seen["lattice"] == true);
    CHECK(seen["slider"] == false);
    CHECK(contains(seen["notes"], "cells of the lattice fold"));
}

TEST_CASE("a page that is too large shows fewer frames, with what these need") {
    auto scene = scenes_of_page(page_of(frame_of(12, 6))).front();
    const auto frame = scene["frames"][0];
    std::mt19937 random(1);
    scene["frames"] = nlohmann::ordered_json::array();
    scene["seams"] = nlohmann::ordered_json::array();
    for (int n = 0; n < 5; ++n) {
        auto each = frame;
        std::string text(600'000, 'A');
        for (auto& letter : text) letter = static_cast<char>('A' + random() % 26);
        each["number"] = n;
        each["voxels"] = text;
        each["seams"] = {n};
        scene["frames"].push_back(each);
        scene["seams"].push_back("seams of " + std::to_string(n));
    }
    const auto page = small_page("t", {scene});
    CHECK(page.frames == 3);
    CHECK(page.html.size() < 2 << 20);
    const auto kept = scenes_of_page(page.html).front();
    REQUIRE(kept["frames"].size() == 3);
    CHECK(kept["frames"][1]["number"] == 2);
    CHECK(kept["seams"][kept["frames"][1]["seams"][0].get<std::size_t>()] == "seams of 2");
    CHECK(kept["seams"].size() == 3);
    CHECK_THROWS_WITH(require_page_size(std::string(21 << 20, ' '), "show less"),
                      "the page would have 21.0 MB, more than 20.0 MB; show less");
}

TEST_CASE(
    "what lies outside the lattice, and seams at an edge of the window, are told at their places",
    "[nightly][browser]") {
    if (!browser_is_there()) return;
    const Scratch scratch;
    PageFrame outside = frame_of(16, 0);
    outside.lattice = std::make_shared<Lattice>(make_box({0, 0, 0}, {16, 16, 8}, 1, {0, 1, 2}));
    const std::string labels = R"js(
        const said = [], label = Picture.prototype.label;
        Picture.prototype.label = function(text, at, colours) { said.push([text, ...at]); label.call(this, text, at, colours); };
        await showFrame();
        document.querySelector('input[value=y]').checked = true;
        showKind();
        draw();
        const {canvas} = views[0].picture, notes = byId('notes').textContent;)js";
    const auto half =
        ask_browser(scratch, page_of(outside),
                    labels + "return {said, notes, above: said[0][2] < canvas.height / 2};");
    REQUIRE(half["said"].size() == 1);
    CHECK(half["said"][0][0] == "50 % outside the lattice");
    CHECK(half["above"] == true);
    CHECK(contains(half["notes"], "50 % of density lies outside the lattice"));

    auto held = frame_of(16, 0);
    const auto& box = *held.lattice;
    auto set = wavy_seams(box, Axis::u, Seams::Kind::remove, 4, 2, 0);
    set.window = Window{4, 12};
    held.seams = {std::make_shared<Seams>(set)};
    const auto edge = ask_browser(scratch, page_of(held),
                                  "document.querySelector('input[value=window]').checked = true; "
                                  "byId('count').value = 2; takeCount();" +
                                      labels + "return {said, notes};");
    REQUIRE(edge["said"].size() == 1);
    CHECK(edge["said"][0][0] == "2 seams at the window's edge");
    CHECK(contains(edge["notes"], "2 seams at the window's edge"));
}
