#include "carve/remap/grid.h"
#include "nodes/page/page_grid.h"
#include "nodes/page/page_html.h"
#include "nodes/page/page_scene.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/browser.h"
#include "tests/support/built_lattices.h"
#include "tests/support/reference_carve.h"
#include "tests/support/wavy_seams.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <map>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

/// Waves in a box of voxels, a tenth of a unit each, that differ from frame to frame.
FloatGrid::Ptr waves(const std::array<int, 3>& size, int frame) {
    auto out = FloatGrid::create();
    out->setName("density");
    out->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
    for (int x = 0; x < size[0]; ++x)
        for (int y = 0; y < size[1]; ++y)
            for (int z = 0; z < size[2]; ++z)
                out->tree().setValue(
                    {x, y, z},
                    static_cast<float>(1.5 + std::sin(0.9 * x + frame) * std::cos(0.7 * y) +
                                       0.5 * std::sin(1.3 * z + 0.4 * x)));
    return out;
}

/// A carve, in the page and by remap.grids.
struct Case {
    std::string name;
    std::array<int, 3> size;
    Lattice lattice;
    std::vector<Seams> sets;
    Softness softness = {};
    double fade = 0;
    std::vector<int> counts = {1, 2, 3, 5, 6};
};

/// A case as the page gets it.
struct Shown {
    Case what;
    FloatGrid::Ptr grid;
    std::vector<Ref<Seams>> sets;
    int frame = 0;
    nlohmann::ordered_json scene;
};

Shown shown(const Case& what) {
    Shown out{what, waves(what.size, 1), {}, 0, {}};
    for (auto each : what.sets) {
        each.find_shifts();
        out.sets.push_back(std::make_shared<Seams>(std::move(each)));
    }
    PageRequest request;
    request.title = request.grid = "density";
    request.setting = "count";
    request.softness = what.softness;
    request.rim_fade = what.fade;
    PageFrame frame;
    frame.number = out.frame = out.sets.front()->frames[out.sets.front()->frames.size() / 2];
    frame.before = out.grid;
    frame.lattice = std::make_shared<Lattice>(what.lattice);
    frame.seams = out.sets;
    out.scene = page_scene(request, {frame});
    return out;
}

/// Checks slices of a case at several counts.
/// @param seen  of each count and axis: `{count, axis, at, slice}`
void check(const Shown& shown, const nlohmann::json& seen) {
    INFO(shown.what.name);
    const auto first = shown.scene["first"].get<std::array<int, 3>>();
    const PageGrid page{shown.grid->transformPtr(), Coord(first[0], first[1], first[2]), 1,
                        shown.scene["size"].get<std::array<int, 3>>()};
    REQUIRE(shown.scene["step"] == 1);
    const auto range = shown.scene["range"].get<std::array<float, 2>>();
    const auto before = page_bytes(page_values(*shown.grid, page), range[0], range[1]);
    std::size_t changed = 0;
    std::map<std::size_t, std::vector<std::uint8_t>> carved_by;
    for (const auto& each : seen) {
        const auto count = each["count"].get<std::size_t>();
        if (!carved_by.contains(count)) {
            CarveMap map(shown.what.lattice, shown.sets, shown.frame, count,
                         std::vector(shown.sets.size(), shown.what.softness));
            if (shown.what.fade > 0) map.fade_rims(shown.what.fade);
            carved_by[count] = page_bytes(
                page_values(*carve_grid(shown.grid, shown.what.lattice, map, Interpolation::linear),
                            page),
                range[0], range[1]);
        }
        const auto& carved = carved_by[count];
        const auto axis = each["axis"].get<int>();
        const int r = axis == 0 ? 1 : 0, t = axis == 2 ? 1 : 2;
        const auto slice = each["slice"].get<std::vector<int>>();
        int worst = 0;
        std::array<int, 3> at{}, worst_at{};
        at[static_cast<std::size_t>(axis)] = each["at"].get<int>();
        std::size_t n = 0;
        for (int up = 0; up < page.size[static_cast<std::size_t>(t)]; ++up)
            for (int right = 0; right < page.size[static_cast<std::size_t>(r)]; ++right, ++n) {
                at[static_cast<std::size_t>(r)] = right;
                at[static_cast<std::size_t>(t)] = up;
                const auto voxel =
                    static_cast<std::size_t>(at[0] + page.size[0] * (at[1] + page.size[1] * at[2]));
                changed += carved[voxel] != before[voxel] ? 1 : 0;
                const int off = std::abs(slice.at(n) - static_cast<int>(carved[voxel]));
                if (off > worst) worst = off, worst_at = at;
            }
        INFO("count " << each["count"] << ", axis " << axis << ", voxel " << worst_at[0] << " "
                      << worst_at[1] << " " << worst_at[2]);
        CHECK(worst <= 1);
    }
    CHECK(changed > 400);
}

/// Checks the middle slice across each axis, as a page with all cases draws it.
void check(const std::vector<Case>& cases) {
    const Scratch scratch;
    std::vector<Shown> all;
    std::vector<nlohmann::ordered_json> scenes;
    std::vector<std::vector<int>> counts;
    for (const auto& each : cases) {
        all.push_back(shown(each));
        scenes.push_back(all.back().scene);
        counts.push_back(each.counts);
    }
    const auto seen =
        ask_browser(scratch, page_html("density", scenes),
                    "const counts = " + nlohmann::json(counts).dump() + R"js(, out = [];
        await showFrame();
        byId('wipe').value = 0;
        byId('together').checked = false;
        for (const axis of ['x', 'y', 'z']) {
            document.querySelector(`input[name=kind][value=${axis}]`).checked = true;
            showKind();
            views.forEach((view, n) => {
                const {scene, picture} = view, place = whole.place(scene, axisNumber[axis], number('at'));
                choose(view);
                for (const count of counts[n]) {
                    byId('count').value = count;
                    takeCount();
                    draw();
                    const [r, t] = sliceAxes[axis], {width, height} = picture.canvas, slice = [], at = [0, 0, 0];
                    const pixels = picture.context.getImageData(0, 0, width, height).data;
                    at[axisNumber[axis]] = place;
                    for (at[t] = 0; at[t] < scene.size[t]; ++at[t])
                        for (at[r] = 0; at[r] < scene.size[r]; ++at[r]) {
                            const [x, y] = picture.project(axis, at, turn);
                            slice.push(pixels[4 * (Math.floor(x) + width * Math.floor(y))]);
                        }
                    (out[n] ??= []).push({count, axis: axisNumber[axis], at: place, slice});
                }
            });
        }
        return out;)js",
                    "--disable-3d-apis --window-size=1600,1600");
    REQUIRE(seen.size() == all.size());
    for (std::size_t n = 0; n < all.size(); ++n) check(all[n], seen[n]);
}

const std::array<int, 3> size{26, 18, 20};

Lattice box_lattice() { return make_box({0, 0, 0}, {26, 18, 20}, 0.1, {0, 1, 2}); }
Lattice ring_lattice() { return ring({1.3, 0.9, 0.2}, {9, 14, 36}, 0.1, {-0.4, 0}); }

}  // namespace

TEST_CASE("the page carves a box as remap.grids does", "[nightly][browser]") {
    if (!browser_is_there()) {
        WARN("chromium is not installed: the page was not looked at");
        return;
    }
    const auto box = box_lattice();
    std::vector<Case> cases;
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
        for (const double soft : {0.0, 3.0}) {
            const auto name = to_text(kind) + (soft > 0 ? " softly" : "");
            cases.push_back(
                {name, size, box, {wavy_seams(box, Axis::u, kind, 9, 6, 2)}, {soft, 0}});
        }
    auto anchored = wavy_seams(box, Axis::v, Seams::Kind::insert, 6, 6, 1);
    anchored.anchor.at = Anchor::At::middle;
    cases.push_back({"anchored", size, box, {anchored}, {1.5, 0}});
    anchored.anchor = {Anchor::At::vertex, 12};
    cases.push_back({"anchored at a vertex", size, box, {anchored}});
    cases.push_back(
        {"faded", size, box, {wavy_seams(box, Axis::u, Seams::Kind::remove, 9, 6, 2)}, {2, 0}, 4});
    std::mt19937 random(7);
    for (const double soft : {0.0, 2.0}) {
        cases.push_back(
            {"pairs",
             size,
             box,
             {random_pairs(random, box, box.shape, Axis::u, Seams::Kind::remove, 6, {1})},
             {soft, 0}});
        cases.push_back(
            {"frames",
             size,
             box,
             {random_seams(random, box, box.shape, Axis::u, Seams::Kind::remove, 6, {1, 2, 3})},
             {soft, 1}});
    }
    const auto first = wavy_seams(box, Axis::v, Seams::Kind::insert, 6, 3, 1);
    auto second = wavy_seams(box, Axis::u, Seams::Kind::remove, 9, 6, 2);
    second = random_seams(random, box, first.shape_after(3), Axis::u, Seams::Kind::remove, 6, {1});
    for (const double soft : {0.0, 2.0})
        cases.push_back({"a chain", size, box, {first, second}, {soft, 0}});
    check(cases);
}

TEST_CASE("the page carves lattices that turn, and boxes between the voxels, as remap.grids does",
          "[nightly][browser]") {
    if (!browser_is_there()) return;
    std::vector<Case> cases;
    const auto round = ring_lattice(),
               oblique = turned(make_box({0.33, 0.11, 0.05}, {20, 16, 18}, 0.09, {0, 1, 2}), 0.2);
    for (const auto& lattice : {round, oblique})
        for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
            for (const double soft : {0.0, 3.0}) {
                const auto axis = lattice.closed ? Axis::v : Axis::u;
                cases.push_back(
                    {lattice.description + " " + to_text(kind) + (soft > 0 ? " softly" : ""),
                     size,
                     lattice,
                     {wavy_seams(lattice, axis, kind, 4, 6, 1)},
                     {soft, 0}});
            }
    cases.push_back({"outwards",
                     size,
                     round,
                     {wavy_seams(round, Axis::u, Seams::Kind::remove, 2, 3, 1)},
                     {3, 0},
                     0,
                     {1, 2, 3}});
    auto bent = helix({10, 8, 30}, 0.08, 1.2, 0.3);
    for (auto& plane : bent.planes) plane.origin += openvdb::Vec3d(0.1, 0.5, 0.8);  // into the grid
    bent.hash = lattice_hash(bent);
    cases.push_back(
        {"helix", size, bent, {wavy_seams(bent, Axis::u, Seams::Kind::remove, 2, 6, 1)}, {2, 0}});
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
        for (const double soft : {0.0, 2.0}) {
            auto along = wavy_seams(bent, Axis::w, kind, 12, 6, 1);
            cases.push_back({"along the helix", size, bent, {along}, {soft, 0}});
            along.anchor.at = Anchor::At::middle;
            cases.push_back({"from both ends of the helix", size, bent, {along}, {soft, 0}});
            cases.push_back({"along a box",
                             size,
                             box_lattice(),
                             {wavy_seams(box_lattice(), Axis::w, kind, 9, 6, 1)},
                             {soft, 0}});
        }
    check(cases);
}

TEST_CASE("the page carves lattices around a rig as remap.grids does", "[nightly][browser]") {
    if (!browser_is_there()) return;
    std::vector<Case> cases;
    const auto tube =
        around(through({{0.5, 0.8, 0.3}, {1.1, 1.0, 0.9}, {2.0, 0.85, 1.5}}), 0.75, 0.1);
    std::vector<Vec3d> circle;
    for (int n = 0; n < 200; ++n)
        circle.push_back(
            {1.25 + 0.75 * std::cos(M_PI * n / 100), 0.9 + 0.6 * std::sin(M_PI * n / 100), 0.95});
    const auto loop = around(through(circle, true), 0.45, 0.1);
    for (const auto& lattice : {tube, loop})
        for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
            for (const double soft : {0.0, 2.0})
                cases.push_back(
                    {lattice.description + " " + to_text(kind) + (soft > 0 ? " softly" : ""),
                     size,
                     lattice,
                     {wavy_seams(lattice, Axis::u, kind, 2, 2, 0.5)},
                     {soft, 0},
                     0,
                     {1, 2}});
    cases.push_back({"faded",
                     size,
                     tube,
                     {wavy_seams(tube, Axis::u, Seams::Kind::remove, 2, 3, 1)},
                     {1, 0},
                     3,
                     {1, 2, 3}});
    check(cases);
}
