#include "tests/support/files/well_formed.h"
#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <regex>
#include <set>

namespace fs = std::filesystem;

namespace {

/// The ring, small and quick, with all that it writes in a folder.
std::string ring(const Scratch& scratch) {
    return "run pipelines/vortex.yaml --progress none --set count=-2 --set out=" +
           (scratch / "ring.####.vdb") + " --set seams=" + (scratch / "seams.vdb") +
           " --set sheet=" + (scratch / "sheet.png") + " ";
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// What a browser says of a page in a window of a width: {inner, scroll, background, pictures,
/// loaded, outside}.
nlohmann::json look(const Scratch& scratch, const std::string& page, int width, bool dark) {
    // Windows of a browser are no narrower than 500 pixels; frames are.
    const auto frame =
        scratch.write("frame.html", R"js(<style>body { margin: 0 }</style><script>
        function look(frame) {
            const inside = frame.contentDocument, all = [...inside.querySelectorAll('body *')];
            const out = document.createElement('pre');
            out.id = 'out';
            out.textContent = JSON.stringify({
                inner: frame.contentWindow.innerWidth, scroll: inside.documentElement.scrollWidth,
                background: frame.contentWindow.getComputedStyle(inside.body).backgroundColor,
                pictures: [...inside.images].map(picture => picture.naturalWidth),
                loaded: frame.contentWindow.performance.getEntriesByType('resource').filter(each => !each.name.startsWith('data:')).length,
                outside: all.filter(each => each.getBoundingClientRect().right > frame.contentWindow.innerWidth + 1 && !each.closest('.scroll')).length});
            document.head.append(out);
        }</script><iframe onload="look(this)" src="file://)js" +
                                        page + "\" style=\"border: 0; height: 3600px; width: " +
                                        std::to_string(width) + "px\"></iframe>");
    const auto pictures = fs::path(FLUIDCARVE_PROGRAM).parent_path() / "page";
    fs::create_directories(pictures);
    const auto picture =
        (pictures / (std::to_string(width) + (dark ? "_dark.png" : "_light.png"))).string();
    fs::remove(picture);
    const auto called = call_shell(
        "timeout 120 chromium --headless --no-sandbox --disable-gpu --hide-scrollbars "
        "--allow-file-access-from-files --user-data-dir=" +
        (scratch / "profile") + " --blink-settings=preferredColorScheme=" + (dark ? "0" : "1") +
        " --window-size=" + std::to_string(std::max(500, width)) +
        ",3600 --dump-dom --screenshot=" + picture + " file://" + frame);
    std::smatch found;
    INFO(called.err);
    REQUIRE(std::regex_search(called.out, found, std::regex(R"(<pre id="out">(.*?)</pre>)")));
    CHECK(fs::exists(picture));
    return nlohmann::json::parse(found.str(1));
}

}  // namespace

TEST_CASE(
    "a run's page has the picture, the graph, the times, the seams and every value, and stands "
    "alone",
    "[long]") {
    const Scratch scratch;
    const auto page = scratch / "new/folder/page.html";
    const auto ran = fluidcarve_program(ring(scratch) + "-q --html " + page + " --report " +
                                        (scratch / "report.json"));
    CHECK(ran.err == "");
    REQUIRE(ran.code == 0);
    const auto text = Scratch::read(page);
    CHECK(well_formed(text));
    const auto checked = call_shell("python3 " + scratch.write("check.py", R"(
import base64, html.parser, re, sys
text = open(sys.argv[1], encoding='utf-8').read()
class Links(html.parser.HTMLParser):
    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ('src', 'href') and not value.startswith(('#', 'data:')): print(tag, name, value)
Links().feed(text)
picture = base64.b64decode(re.search('data:image/png;base64,([^"]*)', text).group(1), validate=True)
print(picture == open(sys.argv[2], 'rb').read())
)") + " " + page + " " + (scratch / "sheet.png"));
    CHECK(checked.err == "");
    CHECK(checked.out == "True\n");
    for (const auto* part :
         {"Done: 6 frames", "2 removed", "<g class=\"node heat", "seam.pyramid",
          "<circle class=\"energy\"", "--set", "pipelines/vortex.yaml:", "default"})
        CHECK(contains(text, part));
    const auto report = nlohmann::json::parse(Scratch::read(scratch / "report.json"));
    for (const auto& [name, node] : report["nodes"].items())
        CHECK(contains(text, "<a href=\"#node-" + name + "\">" + name + "</a>"));
}

TEST_CASE("a run that fails has its page, too") {
    const Scratch scratch;
    const auto ran = fluidcarve_program(ring(scratch) + "--set sim=" + (scratch / "no.####.vdb") +
                                        " --html " + (scratch / "page.html"));
    CHECK(ran.code == 3);
    const auto text = Scratch::read(scratch / "page.html");
    CHECK(well_formed(text));
    CHECK(contains(text, "Not run: an input is missing"));
    CHECK(contains(text, "Failed frame: 41<"));
    CHECK(contains(text, scratch / "no.0041.vdb"));
}

TEST_CASE(
    "page and profile are never written over what a pipeline uses, over each other, or where "
    "nothing can be written") {
    const Scratch scratch;
    const auto refused = [&](const std::string& options, int code, const std::string& message) {
        const auto ran = fluidcarve_program(ring(scratch) + options);
        CHECK(ran.code == code);
        CHECK(ran.err == message);
    };
    refused("--html " + (scratch / "ring.0042.vdb"), 2,
            "--html would overwrite " + (scratch / "ring.0042.vdb") + ": 'out' writes it\n");
    refused("--profile pipelines/vortex.yaml", 2,
            "--profile would overwrite pipelines/vortex.yaml: it is the pipeline\n");
    refused("--report " + (scratch / "a") + " --html " + (scratch / "./a"), 2,
            "--report and --html name the same file: " + (scratch / "./a") + "\n");
    const auto file = scratch.write("file", "");
    const auto ran = fluidcarve_program(ring(scratch) + "--html " + file + "/page.html");
    CHECK(ran.code == 1);
    CHECK_THAT(ran.err, Catch::StartsWith("failed: page: "));
    CHECK_FALSE(fs::exists(scratch / "sheet.png"));
}

TEST_CASE(
    "a profile is a trace that says which node ran when, on which thread, and what was kept and "
    "loaded") {
    const Scratch scratch;
    const auto profile = [&] {
        REQUIRE(fluidcarve_program(ring(scratch) + "-q --threads 2 --work " + (scratch / "work") +
                                   " --profile " + (scratch / "trace.json"))
                    .code == 0);
        std::map<std::string, std::set<std::string>> out;
        const auto trace = nlohmann::json::parse(Scratch::read(scratch / "trace.json"));
        for (const auto& event : trace["traceEvents"])
            if (event["ph"] == "X") {
                CHECK(event["dur"].get<double>() >= 0);
                CHECK(event["tid"].get<int>() >= 1);
                out[event["cat"]].insert(
                    event["name"].get<std::string>() +
                    (event["args"].contains("frame") ? " " + event["args"]["frame"].dump() : ""));
            }
        return out;
    };
    auto seen = profile();
    for (const auto* frame : {"41", "43", "46"})
        for (const auto* node : {"sim ", "edges ", "energy ", "carved ", "out "})
            CHECK(seen["run"].count(std::string(node) + frame) == 1);
    CHECK(seen["finish"].count("seams") == 1);
    CHECK(seen["keep"].count("edges 41") == 1);
    fs::remove(scratch / "ring.0042.vdb");
    seen = profile();
    CHECK(seen["run"] == std::set<std::string>{"sim 42", "carved 42", "out 42"});
    CHECK(seen["load"].count("seams") == 1);
}

TEST_CASE("a browser shows the page wide and narrow, light and dark, without scrolling sideways",
          "[nightly][browser]") {
    if (call_shell("command -v chromium").code != 0) {
        WARN("chromium is not installed: the page was not looked at");
        return;
    }
    const Scratch scratch;
    const auto page = scratch / "page.html";
    REQUIRE(fluidcarve_program(ring(scratch) + "-q --html " + page).code == 0);
    for (const int width : {1280, 400})
        for (const bool dark : {false, true}) {
            INFO(width << (dark ? " dark" : " light"));
            const auto seen = look(scratch, page, width, dark);
            CHECK(seen["inner"] == width);
            CHECK(seen["scroll"].get<int>() <= width);
            CHECK(seen["outside"] == 0);
            CHECK(seen["loaded"] == 0);
            CHECK(seen["pictures"].size() == 1);
            CHECK(seen["pictures"][0].get<int>() > 100);
            CHECK(seen["background"] == (dark ? "rgb(20, 23, 26)" : "rgb(255, 255, 255)"));
        }
}
