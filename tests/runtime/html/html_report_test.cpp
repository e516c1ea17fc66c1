#include "runtime/html/html_report.h"
#include "graph/build_pipeline.h"
#include "runtime/html/plot.h"
#include "tests/support/files/well_formed.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <limits>
#include <regex>

using namespace fluidcarve;
using Json = nlohmann::ordered_json;

namespace {

const std::string magic = "\x89PNG\r\n\x1a\n";

/// Paths in the pipeline are short: the test works in its own folder.
struct Inside {
    explicit Inside(const std::string& folder) { std::filesystem::current_path(folder); }
    ~Inside() { std::filesystem::current_path(before); }
    const std::filesystem::path before = std::filesystem::current_path();
};

/// A small pipeline and a page of it.
struct PageBench {
    explicit PageBench(const std::string& path = "p&q.yaml") {
        Problems problems;
        scratch.write(path,
                      "fluidcarve: 1\nframes: 1-3\nparams:\n  by: {type: float, default: 2, doc: "
                      "By.}\nnodes:\n  count: {type: toy.count, path: in.##}\n"
                      "  square: {type: toy.square, number: count, times: \"${by}\"}\n  best: "
                      "{type: toy.top, number: square}\n"
                      "  out: {type: toy.save, number: square, text: best, path: out.##.png}\n");
        const auto document = read_document(path, {"best.count=2"}, problems);
        pipeline = build_pipeline(document, registry, problems);
        REQUIRE(to_text(problems) == "");
        sources = value_sources_of(document, registry);
    }

    std::string page() const {
        return to_html({pipeline, registry, sources, report, files, "today"});
    }

    const Scratch scratch;
    const Inside inside{scratch.path()};
    const Registry registry = toy::registry();
    Pipeline pipeline;
    ValueSources sources;
    Json report = Json::parse(
        R"({"fluidcarve": "9.8.7", "pipeline": "p", "frames": [1, 2, 3], "exit": 0, "wall_s": 1.5, "peak_rss_bytes": 82000000,
        "nodes": {"count": {"type": "toy.count", "frames": 3, "cached": 0, "wall_s": 3.0, "bytes": 8},
                  "square": {"type": "toy.square", "frames": 3, "cached": 3, "wall_s": 0.0, "bytes": 0},
                  "best": {"type": "toy.top", "frames": 3, "cached": 0, "wall_s": 1.0, "bytes": 123456, "taken": {"frames": 3, "cached": 1}}},
        "seams": {}, "failures": [], "warnings": []})");
    WrittenFiles files;
};

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t out = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++out;
    return out;
}

/// The part of a page under a heading.
std::string section(const std::string& page, const std::string& title) {
    const auto begin = page.find("<h2>" + title + "</h2>");
    if (begin == std::string::npos) return {};
    return page.substr(begin, page.find("<h2>", begin + 1) - begin);
}

Json seams(const std::string& fields) {
    return Json::parse(R"({"axis": "u", "kind": "remove", "shape": [5, 6, 7, 3], )" + fields + "}");
}

}  // namespace

TEST_CASE("a page is well-formed, escapes what others wrote, and loads nothing") {
    PageBench bench;
    const std::string nasty =
        "<script>alert(\"x\" & 'y')</script>\n<img src=\"http://elsewhere/\">";
    bench.report["warnings"].push_back({{"node", "count"}, {"message", nasty}});
    bench.report["failures"].push_back({{"node", nasty}, {"message", nasty}, {"frame", 2}});
    bench.report["seams"][nasty] = seams(
        R"("energy": [2.0, 3.0], "lower_bound": [null, 2.9], "gap": [null, 0.03], "wall_s": [0.1, 0.2])");
    bench.report["points"]["count"] = Json{{nasty, nasty}};
    bench.files.pictures.push_back({"out", "a\"b.png", magic, "", false});
    bench.sources.params.emplace_back(nasty, ValueSource{nasty, nasty, {nasty}});
    const auto page = bench.page();
    CHECK(well_formed(page));
    CHECK_THAT(page, Catch::StartsWith("<!DOCTYPE html>\n<html lang=\"en\">") &&
                         Catch::EndsWith("</html>\n"));
    CHECK(count(page, "<script") == 0);
    CHECK(count(page, "&lt;script&gt;alert(&quot;x&quot; &amp; 'y')&lt;/script&gt; &lt;img src=") >=
          6);
    CHECK_THAT(page, Catch::Contains("<title>p&amp;q.yaml") &&
                         Catch::Contains("<h1>p&amp;q.yaml</h1>") &&
                         Catch::Contains("a&quot;b.png"));
    CHECK(count(page, "<img ") == 1);
    // Whatever a page may load, it would name so.
    const std::regex link(R"((src|href|data|action)="([^"]*)\")"), url(R"(url\(|@import)");
    for (std::sregex_iterator each(page.begin(), page.end(), link), end; each != end; ++each)
        CHECK((each->str(2).starts_with("#node-") ||
               each->str(2).starts_with("data:image/png;base64,")));
    CHECK_FALSE(std::regex_search(page, url));
    CHECK_THAT(page, Catch::Contains("Content-Security-Policy\" content=\"default-src 'none'"));
}

TEST_CASE("a page says how the run ended, what failed and what it warned of") {
    PageBench bench;
    CHECK_THAT(bench.page(),
               Catch::Contains("Done: 3 frames in 1.50 s") && Catch::Contains("82.0 MB") &&
                   Catch::Contains("fluidcarve 9.8.7, today") &&
                   Catch::Contains("3 of 9 results") && Catch::Contains("<dd>1-3 (3)</dd>"));
    CHECK_THAT(bench.page(), !Catch::Contains("<h2>Failures") && !Catch::Contains("<h2>Warnings") &&
                                 !Catch::Contains("<h2>Seams"));
    for (const auto& [code, words] :
         std::map<int, std::string>{{1, "Failed after 1.50 s"},
                                    {3, "Not run: an input is missing"},
                                    {4, "Done in 1.50 s, but some frames failed"},
                                    {130, "Interrupted after 1.50 s"}}) {
        bench.report["exit"] = code;
        CHECK_THAT(bench.page(), Catch::Contains("<p class=\"outcome bad\">" + words));
    }
    for (const int frame : {3, 1})
        bench.report["failures"].push_back(
            {{"node", "square"}, {"message", "too large"}, {"frame", frame}});
    bench.report["failures"].push_back({{"node", "best"}, {"message", "needs every frame"}});
    bench.report["warnings"].push_back({{"node", "count"}, {"message", "odd"}});
    const auto page = bench.page();
    CHECK_THAT(section(page, "Failures"),
               Catch::Contains("Failed frames: 1,3<") &&
                   Catch::Contains("square (toy.square), frame 3</small>too large") &&
                   Catch::Contains("best (toy.top)</small>needs every frame"));
    CHECK_THAT(section(page, "Warnings"), Catch::Contains("count (toy.count)</small>odd"));
}

TEST_CASE("a page shows what a carve did to each grid, before and after, and not frame by frame") {
    PageBench bench;
    CHECK_THAT(bench.page(), !Catch::Contains("<h2>Carved grids"));
    bench.report["grids"] = Json::parse(R"({"carved": {"a<b": {"frames": 3,
        "before": {"box": [[-0.5, 0, 1], [9.5, 4, 3]], "mass": 160.0, "highest": 1.5, "centre": [4.5, 1.5, 2.25], "flicker": 0.125}, "after": {"mass": 0.0}}}})");
    bench.report["grids_by_frame"] = Json::parse(R"({"carved": {"1": {"a<b": {}}}})");
    const auto page = bench.page();
    CHECK(well_formed(page));
    CHECK_THAT(
        section(page, "Carved grids"),
        Catch::Contains(
            "<tr><th>carved.a&lt;b before</th><td class=\"number\">10 × 4 × 2</td><td "
            "class=\"number\">160</td><td class=\"number\">1.5</td>"
            "<td class=\"number\">4.5, 1.5, 2.25</td><td class=\"number\">0.125</td></tr>") &&
            Catch::Contains("<tr><th>carved.a&lt;b after</th><td class=\"number\">empty</td><td "
                            "class=\"number\">0</td><td class=\"number\"></td>"));
    CHECK_THAT(page, !Catch::Contains("<h2>Grids"));
    // A plugin may give the section another form.
    bench.report["grids"] = Json::parse(
        R"({"carved": 3, "other": {"a": [1], "b": {"before": {"box": [1, [2], "x"]}}}})");
    CHECK(well_formed(bench.page()));
}

TEST_CASE("a run that never began has a page: what failed, and the pipeline") {
    PageBench bench;
    bench.report["nodes"] = Json::object();
    bench.report["exit"] = 3;
    bench.report["failures"].push_back(
        {{"node", "count"}, {"message", "the file is not there"}, {"frame", 2}});
    const auto page = bench.page();
    CHECK(well_formed(page));
    CHECK_THAT(page, Catch::Contains("the file is not there") && !Catch::Contains("<h2>Nodes"));
    CHECK(count(section(page, "Graph"), "not in this run</text>") == 3);
    CHECK_THAT(section(page, "Graph"), Catch::Contains("class=\"node idle failed\""));
    CHECK_THAT(section(page, "Pipeline"), Catch::Contains("out.##.png"));
}

TEST_CASE(
    "the graph has the colour of each node's share of the time, of what was kept, and of what "
    "failed") {
    PageBench bench;
    const auto graph = section(bench.page(), "Graph");
    for (const auto* part : {"<g class=\"node heat4\"", "3.00 s, 75 %", "<g class=\"node kept\"",
                             "<g class=\"node heat3\"", "1.00 s, 25 %", "<g class=\"node idle\"",
                             "over 50 %", "25 to 50 %", "<i class=\"kept\"></i>from earlier runs",
                             "<i class=\"idle\"></i>not in this run"})
        CHECK_THAT(graph, Catch::Contains(part));
    CHECK_THAT(graph, !Catch::Contains("under 2 %") && !Catch::Contains("class=\"failed\""));
}

TEST_CASE("the table has time, memory and files of each node, bars by time") {
    PageBench bench;
    bench.files.bytes["best"] = 2500000;
    const auto table = section(bench.page(), "Nodes");
    for (const auto* part : {"<a href=\"#node-count\">count</a>", "width:100.0%", "width:33.3%",
                             ">3.00 s<", ">1.00 s<", ">0.33 s<", ">123 kB<", ">2.50 MB<", ">8 B<"})
        CHECK_THAT(table, Catch::Contains(part));
    CHECK(count(table, "class=\"meter\"") == 2);
    CHECK_THAT(bench.page(), Catch::Contains("<h3 id=\"node-count\">"));
}

TEST_CASE("energies stand over their bounds, the gap beside them, and all numbers below") {
    PageBench bench;
    bench.report["seams"]["best"] = seams(
        R"("energy": [100.0, 110.0, 140.0], "lower_bound": [99.0, 100.0, null], "gap": [0.01, 0.1, null], "wall_s": [0.1, 0.2, 0.3])");
    auto part = section(bench.page(), "Seams");
    CHECK(count(part, "<circle class=\"energy\"") == 3);
    CHECK(count(part, "<circle class=\"bound\"") == 2);
    CHECK(count(part, "<circle class=\"gap\"") == 2);
    CHECK(count(part, "class=\"band\"") == 1);
    for (const auto* words :
         {"3 seams removed across u, in a lattice of 5 × 6 × 7 vertices and 3 frames.",
          "A lower bound is known for 2 of them", "at most 10.0 % more",
          "seam 2: energy 110, at least 100", "seam 3: energy 140</title>",
          "<td class=\"number\">10.0 %</td>", "<td class=\"number\">0.20 s</td>",
          "<td class=\"number\">–</td>"})
        CHECK_THAT(part, Catch::Contains(words));

    bench.report["seams"]["best"] = seams(
        R"("energy": [100.0, 110.0], "lower_bound": [null, null], "gap": [null, null], "pair_energy": [1.0, 2.0])");
    part = section(bench.page(), "Seams");
    CHECK(count(part, "<svg class=\"plot\"") == 2);
    CHECK_THAT(part, Catch::Contains("as many inserted in the pair window") &&
                         !Catch::Contains("lower bound</li>") &&
                         !Catch::Contains("<circle class=\"gap\""));

    bench.report["seams"]["best"] =
        seams(R"("energy": [100.0], "lower_bound": [100.0], "gap": [1e-14])");
    CHECK_THAT(section(bench.page(), "Seams"),
               Catch::Contains("no seam has less energy") && !Catch::Contains("class=\"gap\""));
    bench.report["seams"]["best"] = seams(R"("energy": [])");
    CHECK(well_formed(bench.page()));
    // A plugin may report what it likes.
    for (const auto* odd :
         {"7", "[1, 2]", "{}", "null",
          R"({"energy": 3, "axis": 1, "kind": [], "shape": [1, null, 3, -2], "gap": "x"})"}) {
        bench.report["seams"]["best"] = Json::parse(odd);
        CHECK(well_formed(bench.page()));
    }
    bench.report["seams"]["other"] = seams(R"("energy": [7.0])");
    CHECK_THAT(bench.page(), Catch::Contains("<h2>Seams of best</h2>") &&
                                 Catch::Contains("<h2>Seams of other</h2>"));
}

TEST_CASE("what else nodes report stands in tables: once, or a row per frame") {
    PageBench bench;
    bench.report["points"] = Json::parse(
        R"({"moved": {"1": {"points": 5, "deleted": 2}, "2": {"points": 6}}, "wet": {"all": {"points": 9}}})");
    bench.report["lattices"] =
        Json::parse(R"({"ring": {"closed": true, "shape": [2, 3], "shared_voxels": 4}})");
    bench.report["totals"] = Json::parse(R"({"sum": 12.5})");
    const auto page = bench.page();
    for (const auto* part :
         {"<th>moved, frame 2</th><td class=\"number\">6</td><td class=\"number\"></td>",
          "<th>wet</th><td class=\"number\">9</td>", ">deleted</th>"})
        CHECK_THAT(section(page, "Points"), Catch::Contains(part));
    CHECK_THAT(section(page, "Lattices"), Catch::Contains(">shared voxels</th>") &&
                                              Catch::Contains(">yes<") &&
                                              Catch::Contains(">2, 3<"));
    CHECK_THAT(section(page, "Totals"),
               Catch::Contains("<th>sum</th><td class=\"number\">12.5</td>"));
}

TEST_CASE("every value of the pipeline stands with its source, defaults apart") {
    const PageBench bench;
    const auto part = section(bench.page(), "Pipeline");
    for (const auto* row :
         {"<th>frames</th><td><code>1-3</code></td><td class=\"from\">p&amp;q.yaml:2</td>",
          "<th>by</th><td><code>2</code></td>",
          "<th>times</th><td><code>2</code></td><td class=\"from\">p&amp;q.yaml:4</td>",
          "<th>count</th><td><code>2</code></td><td class=\"from\">--set</td>",
          "<th>type</th><td><code>toy.square</code></td><td class=\"from\">p&amp;q.yaml:7</td>",
          "<summary>1 default</summary>\n<table "
          "class=\"values\"><tbody>\n<tr><th>offset</th><td><code>0</code></td>"})
        CHECK_THAT(part, Catch::Contains(row));
}

TEST_CASE("pictures are in the page to the last byte, and what is not there is said") {
    PageBench bench;
    CHECK_THAT(section(bench.page(), "Pictures"), Catch::Contains("preview.sheet"));
    const auto start = std::filesystem::file_time_type::clock::now();
    const auto look = [&] {
        return bench.files =
                   written_files(bench.pipeline, {2, 3}, bench.report, start, "report.html");
    };
    REQUIRE(look().pictures.size() == 1);
    CHECK_THAT(
        section(bench.page(), "Pictures"),
        Catch::Contains("out writes out.02.png, which is not there.") && !Catch::Contains("<img"));
    CHECK(bench.files.bytes.empty());

    bench.scratch.write("out.02.png", magic + std::string("\0\xff\x10", 3));
    bench.scratch.write("out.03.png", "12345");
    std::filesystem::last_write_time("out.02.png", start + std::chrono::seconds(1));
    look();
    CHECK(bench.files.bytes == std::map<std::string, std::uint64_t>{{"out", 11 + 5}});
    CHECK_THAT(section(bench.page(), "Pictures"),
               Catch::Contains("src=\"data:image/png;base64,iVBORw0KGgoA/xA=\"") &&
                   Catch::Contains(">out.02.png, written by out<"));

    std::filesystem::last_write_time("out.02.png", start - std::chrono::hours(1));
    look();
    CHECK_THAT(section(bench.page(), "Pictures"),
               Catch::Contains("written by out in an earlier run<"));
    bench.report["nodes"]["out"] = {
        {"type", "toy.save"}, {"frames", 2}, {"cached", 2}, {"wall_s", 0.0}, {"bytes", 0}};
    look();
    CHECK_THAT(section(bench.page(), "Pictures"), Catch::Contains(">out.02.png, written by out<"));

    bench.scratch.write("out.02.png", "no picture");
    look();
    CHECK_THAT(section(bench.page(), "Pictures"), Catch::Contains("which is no PNG file."));
}

TEST_CASE("a plot has few round numbers at its axes and gaps where values are missing") {
    const auto numbers = [](const std::string& svg, const std::string& anchor) {
        std::vector<std::string> out;
        const std::regex text("text-anchor=\"" + anchor + "\">([^<]*)<");
        for (std::sregex_iterator each(svg.begin(), svg.end(), text), end; each != end; ++each)
            out.push_back(each->str(1));
        return out;
    };
    using Texts = std::vector<std::string>;
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    auto svg = to_svg(
        LinePlot{"energy", "seam", {{"energy", {4162, 4240, none, 4739}}}, false, false, {}});
    CHECK(well_formed(svg));
    CHECK(numbers(svg, "end") == Texts{"4000", "4200", "4400", "4600", "4800"});
    CHECK(numbers(svg, "middle") == Texts{"1", "2", "3", "4", "seam"});
    CHECK(numbers(svg, "start") == Texts{"energy"});
    CHECK(count(svg, "<circle") == 3);
    CHECK(std::regex_search(svg, std::regex(R"re(d=" M[\d.,]+ L[\d.,]+ M[\d.,]+")re")));

    std::vector<double> many;
    for (int n = 1; n <= 384; ++n) many.push_back(n * 1e4);
    svg = to_svg(LinePlot{"energy", "seam", {{"energy", many}}, true, false, {}});
    CHECK(numbers(svg, "end") == Texts{"0", "1", "2", "3", "4"});
    CHECK(numbers(svg, "start") == Texts{"energy, in 1e6"});
    CHECK(numbers(svg, "middle") == Texts{"1", "100", "200", "300", "seam"});
    CHECK(count(svg, "<circle") == 0);

    for (const auto& values : std::vector<std::vector<double>>{
             {}, {none}, {0}, {5}, {-3, -3}, {1e300, -1e300}, {1e-30}, {0.1, 0.3}}) {
        svg = to_svg(
            LinePlot{"energy", "seam", {{"energy", values}, {"bound", values}}, false, true, {}});
        CHECK(well_formed(svg));
        CHECK_THAT(svg, !Catch::Contains("nan") && !Catch::Contains("inf"));
        CHECK(numbers(svg, "end").size() >= 2);
        CHECK(numbers(svg, "end").size() <= 8);
    }
}
