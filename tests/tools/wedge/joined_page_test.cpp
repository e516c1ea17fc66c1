#include "tools/wedge/joined_page.h"
#include "nodes/page/page_html.h"
#include "tests/support/browser.h"
#include "tests/support/page_frames.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;

TEST_CASE("pages are joined: what they share is written once, and few frames keep them small") {
    const Scratch scratch;
    const auto title = std::string("wedge");
    auto fewer = frame_of(12, 6);
    fewer.seams = {std::make_shared<Seams>(*frame_of(12, 3).seams[0])};
    const auto one = scratch.write("1.html", page_of(frame_of(12, 6))),
               other = scratch.write("2.html", page_of(fewer));
    write_joined_page(
        title, {{one, {{"seams.count", "-6"}}}, {other, {{"seams.count", "-3"}, {"soft", "3"}}}},
        scratch / "new/joined.html");
    const auto page = Scratch::read(scratch / "new/joined.html");
    const auto scenes = scenes_of_page(page);
    REQUIRE(scenes.size() == 2);
    CHECK(scenes[1]["differs"][1] == nlohmann::ordered_json{"soft", "3"});
    CHECK(scenes[0]["frames"] == scenes[1]["frames"]);
    auto alone = scenes_of_page(Scratch::read(one)).front();
    alone["differs"] = scenes[0]["differs"];
    CHECK(alone == scenes[0]);
    CHECK(page.size() < page_of(frame_of(12, 6)).size() + 8000);

    const auto text = scratch.write("3.html", "<p>no page</p>");
    CHECK_THROWS_WITH(write_joined_page(title, {{text, {}}}, scratch / "x.html"),
                      Catch::Contains("3.html: it is no page"));
    CHECK_THROWS_WITH(write_joined_page(title, {{scratch / "no.html", {}}}, scratch / "x.html"),
                      Catch::Contains("does not exist"));
}

TEST_CASE(
    "scenes stand side by side: controls are for all, the count for the one chosen or for all",
    "[nightly][browser]") {
    if (!browser_is_there()) return;
    const Scratch scratch;
    const auto one = scratch.write("1.html", page_of(frame_of(16, 6))),
               other = scratch.write("2.html", page_of(frame_of(16, 3)));
    write_joined_page("wedge",
                      {{one, {{"seams.count", "-6"}, {"seams.type", "a b"}}},
                       {other, {{"seams.count", "-3"}, {"seams.type", "c"}}}},
                      scratch / "j.html");
    const auto seen = ask_browser(scratch, Scratch::read(scratch / "j.html"), R"js(
        await showFrame();
        draw();
        const counts = () => views.map(view => view.count), slide = count => { byId('count').value = count; takeCount(); };
        const out = {views: document.querySelectorAll('.view').length, first: byId('setting').value,
            labels: views.map(view => view.part.innerText.split('\n').pop()),
            together: byId('together').checked, shared: views[0].frame.volume === views[1].frame.volume};
        slide(2);
        out.one = counts();
        views[1].choice.click();
        out.most = byId('count').max;
        slide(1);
        out.second = byId('setting').value;
        out.other = counts();
        byId('together').checked = true;
        slide(3);
        out.all = counts();
        const middle = view => {
            const {gl} = volume, [left, low, width, height] = view.pixels, pixel = new Uint8Array(4);
            gl.readPixels(left + (width >> 1), low + (height >> 1), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
            return pixel[0];
        };
        draw();
        out.middles = views.map(middle);
        return out;)js");
    CHECK(seen["views"] == 2);
    CHECK(seen["labels"][0] == "seams.count = -6, seams.type = a b");
    CHECK(seen["first"] == "--set 'seams.type=a b' --set seams.count=-5");
    CHECK(seen["together"] == false);
    CHECK(seen["shared"] == true);
    CHECK(seen["one"] == nlohmann::json{2, 3});
    CHECK(seen["most"] == "3");
    CHECK(seen["second"] == "--set seams.type=c --set seams.count=-1");
    CHECK(seen["other"] == nlohmann::json{2, 1});
    CHECK(seen["all"] == nlohmann::json{3, 3});
    for (const auto& middle : seen["middles"]) CHECK(middle.get<int>() > 110);
}
