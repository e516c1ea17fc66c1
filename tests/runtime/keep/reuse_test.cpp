#include "carve/base/frame_set.h"
#include "graph/build_pipeline.h"
#include "runtime/run/forecast.h"
#include "runtime/run/run.h"
#include "runtime/run/status.h"
#include "tests/runtime/keep/reuse_cases.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sys/resource.h>

using namespace fluidcarve;
namespace fs = std::filesystem;

namespace {

using Lines = std::vector<std::string>;

const Lines everything{"digest 1", "digest 2", "digest 3", "digest 4", "digest 5", "load 1",
                       "load 2",   "load 3",   "load 4",   "load 5",   "save 1",   "save 2",
                       "save 3",   "save 4",   "save 5",   "square 1", "square 2", "square 3",
                       "square 4", "square 5", "step 1",   "step 2"};

const Lines saves{"save 1", "save 2", "save 3", "save 4", "save 5"};

Lines operator+(Lines a, const Lines& b) {
    a.insert(a.end(), b.begin(), b.end());
    std::ranges::sort(a);
    return a;
}

}  // namespace

TEST_CASE("the first run computes each thing once, and says of all that it was never run") {
    Shot shot;
    CHECK(shot.run() == everything);
    CHECK(shot.code == exit_code::done);
    CHECK(shot.why("square") == "never run");
    CHECK(shot.text(3) == "9 25 16 ");
    CHECK(shot.report["nodes"]["square"]["frames"] == 5);
    CHECK(shot.report["nodes"]["square"]["cached"] == 0);
}

TEST_CASE("the second run computes nothing, and tells what the first one told") {
    Shot shot;
    shot.replace("count: 2", "count: 2, doc: two of them");
    shot.set(4, 8);
    shot.run();
    const auto first = shot.report;
    CHECK(shot.run() == Lines{});
    CHECK(shot.code == exit_code::done);
    for (const auto& [name, node] : shot.report["nodes"].items())
        CHECK(node["cached"] == node["frames"]);
    CHECK(shot.report["nodes"].size() == 4);
    CHECK(shot.report["warnings"] == first["warnings"]);
    CHECK(shot.report["warnings"].size() == 2);
    CHECK(shot.report["squares"] == first["squares"]);
    CHECK(shot.report["tops"] == first["tops"]);
}

TEST_CASE("comments, descriptions, names of nodes and the place of the folder change nothing") {
    Shot shot;
    shot.run();
    shot.replace("nodes:", "# a comment\nnodes:");
    shot.replace("count: 2", "count: 2, doc: the two largest");
    CHECK(shot.run() == Lines{});
    shot.replace("square: {", "squared: {");
    shot.replace("top: {type: toy.top, number: square", "top: {type: toy.top, number: squared");
    shot.replace("number: square, text", "number: squared, text");
    CHECK(shot.run() == Lines{});
    fs::rename(shot.folder, shot.scratch / "moved");
    shot.folder = shot.scratch / "moved";
    CHECK(shot.run() == Lines{});
    CHECK(shot.code == exit_code::done);
}

TEST_CASE(
    "a changed parameter reruns its node and what follows, and the forecast says from what to "
    "what") {
    Shot shot;
    shot.run();
    shot.replace("count: 2", "count: 2, offset: 1");
    CHECK(shot.run() == saves + Lines{"step 1", "step 2"});
    CHECK(shot.why("top") == "offset changed from 0 to 1");
    CHECK(shot.why("save") == "changed: top");
}

TEST_CASE("a replaced frame reruns its own work and the gathering nodes") {
    Shot shot;
    shot.run();
    shot.set(4, 7);
    CHECK(shot.run() ==
          Lines{"digest 4", "load 4", "square 4"} + saves + Lines{"step 1", "step 2"});
    CHECK(shot.why("load") == "input frame 4 changed");
    CHECK(shot.why("square") == "changed: load");
    CHECK(shot.text(3) == "9 49 25 ");
    shot.set(4, 4);
    CHECK(shot.run() == saves);
    CHECK(shot.text(3) == "9 25 16 ");
}

TEST_CASE("a replaced file that holds for all frames is told by its name") {
    Shot shot;
    for (const auto& [from, to] : {std::pair("in.##", "in.04"), {"OUT/out.##", "OUT/out"}})
        shot.replace(from, to);
    shot.run();
    shot.set(4, 7);
    shot.run();
    CHECK(shot.why("load") == "input in.04 changed");
}

TEST_CASE("a file that only looks new is known by its content") {
    Shot shot;
    shot.run();
    shot.set(4, 4);
    CHECK(shot.run() == Lines{});
}

TEST_CASE("a growing result answers smaller counts, and larger ones continue it") {
    Shot shot;
    shot.replace("count: 2", "count: 3");
    shot.run();
    CHECK(shot.report["tops"]["top"]["steps"].size() == 3);
    shot.replace("count: 3", "count: 1");
    CHECK(shot.run() == saves);
    CHECK(shot.text(2) == "4 25 ");
    CHECK(shot.report["tops"]["top"]["steps"] == nlohmann::json({"25"}));
    CHECK(shot.run() == Lines{});
    CHECK(shot.report["tops"]["top"]["steps"] == nlohmann::json({"25"}));
    shot.replace("count: 1", "count: 5");
    CHECK(shot.run() == saves + Lines{"step 4", "step 5"});
    CHECK(shot.text(2) == "4 25 16 9 4 1 ");
    CHECK(shot.why("top") == "count changed from 1 to 5; goes on from 3 of 5 items");
    shot.replace("count: 5", "count: 2");
    CHECK(shot.run() == saves);
}

TEST_CASE(
    "an output that is missing, or was changed, is written again, and the others stay as they "
    "are") {
    Shot shot;
    shot.run();
    const auto stays = fs::last_write_time(shot.folder + "/out/out.01");
    fs::remove(shot.folder + "/out/out.02");
    std::ofstream(shot.folder + "/out/out.05") << "by hand";
    CHECK(shot.run() == Lines{"save 2", "save 5"});
    CHECK(shot.why("save") == "its files are missing, or not as it wrote them");
    CHECK(shot.text(5) == "25 25 16 ");
    CHECK(fs::last_write_time(shot.folder + "/out/out.01") == stays);
    shot.replace("OUT", "OUT/more");
    CHECK(shot.run() == saves);
    CHECK(shot.run() == Lines{});
    shot.replace("OUT/more", "OUT");
    CHECK(shot.run() == Lines{});
}

TEST_CASE("a pipeline says itself what is kept") {
    Shot shot;
    shot.replace("number: load}", "number: load, cache: false}");
    shot.replace("path: OUT/out.##}", "path: OUT/out.##, cache: false}");
    shot.replace("in.##}", "in.##, cache: true}");
    shot.run();
    CHECK(shot.run() == saves + Lines{"square 1", "square 2", "square 3", "square 4", "square 5"});
    CHECK(shot.why("square") == "for save");
    CHECK(shot.why("save") == "its results are not kept");
}

TEST_CASE("of many nodes upstream, those that changed are named, the first three of them") {
    Shot shot;
    std::string all;
    shot.yaml = "fluidcarve: 1\nframes: 1-5\nnodes:\n  load: {type: toy.load, path: in.##}\n";
    for (int n = 0; n < 200; ++n) {
        shot.yaml += fmt::format("  s{0}: {{type: toy.square, number: load, times: {0}.0}}\n", n);
        all += fmt::format("{}s{}", n == 0 ? "" : ", ", n);
    }
    shot.yaml += "  sum: {type: toy.add, numbers: [" + all +
                 "]}\n  save: {type: toy.save, number: sum, path: OUT/out.##}\n";
    shot.run();
    for (const int n : {3, 64, 130, 131, 199})
        shot.replace(fmt::format("times: {}.0}}", n), fmt::format("times: {}.5}}", n));
    shot.run();
    CHECK(shot.why("sum") == "changed: s3, s64, s130 and 2 others");
    CHECK(shot.why("save") == shot.why("sum"));
    CHECK(shot.why("s2") == "");
}

TEST_CASE("ten thousand nodes in a chain are planned within 400 MB") {
    const auto peak_kb = [] {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        return usage.ru_maxrss;
    };
    Shot shot;
    std::string yaml = "fluidcarve: 1\nframes: 1-5\nnodes:\n  s0: {type: toy.load, path: in.##}\n";
    for (int n = 1; n < 10000; ++n)
        yaml += fmt::format("  s{}: {{type: toy.add, numbers: s{}}}\n", n, n - 1);
    const auto file = shot.folder + "/p.yaml";
    std::ofstream(file) << yaml;
    const auto registry = toy::registry();
    Problems problems;
    const auto pipeline = build_pipeline(read_document(file, {}, problems), registry, problems);
    REQUIRE(problems.empty());
    shot.request.options.work_folder = shot.folder + "/kept";
    const auto before = peak_kb();
    CHECK(shot.forecast_of(pipeline, registry)["nodes"]["s9999"]["why"] == "never run");
    CHECK(peak_kb() - before < 400'000);
}

TEST_CASE("without the cache everything runs, and nothing is left") {
    Shot shot;
    shot.request.options.cache = false;
    const auto twice = shot.run();
    CHECK(std::ranges::count(twice, "square 3") == 2);
    CHECK(shot.run() == twice);
    CHECK_FALSE(fs::exists(shot.folder + "/kept"));
}

TEST_CASE("damaged results are computed again, and everything comes out the same") {
    Shot shot;
    shot.run();
    for (const auto& each : fs::recursive_directory_iterator(shot.folder + "/kept/cache"))
        if (each.is_regular_file()) {
            auto bytes = Scratch::read(each.path());
            for (const auto at : {bytes.size() / 3, bytes.size() - 20})
                bytes[at] = static_cast<char>(bytes[at] ^ 4);
            std::ofstream(each.path(), std::ios::binary) << bytes;
        }
    shot.replace("count: 2", "count: 4");
    shot.run();
    CHECK(shot.code == exit_code::done);
    CHECK(shot.text(3) == "9 25 16 9 4 ");
    CHECK(shot.run() == Lines{});
}

TEST_CASE("a stopped run, run again, repeats nothing that was done") {
    Shot shot;
    shot.replace("number: load}", "number: load, slow_ms: 5}");
    shot.request.options.threads = 1;
    shot.request.options.in_flight = 1;
    int asked = 0;
    const auto first = shot.run([&] { return ++asked > 12; });
    REQUIRE(shot.code == exit_code::interrupted);
    REQUIRE(first.size() < everything.size());
    auto second = shot.run();
    CHECK(shot.code == exit_code::done);
    for (const auto& line : first)
        if (!line.starts_with("load")) CHECK(std::ranges::count(second, line) == 0);
    CHECK(shot.why("square") == "was not finished, or is no longer kept");
    CHECK(shot.text(3) == "9 25 16 ");
}

TEST_CASE(
    "parts of a run add up: chunks of what a solver takes, the solver, chunks of what is "
    "delivered") {
    Shot shot;
    std::string fault;
    shot.request.target.to = "top.number";
    shot.request.target.frames = FrameSet::parse("1-2", fault);
    CHECK(shot.run() == Lines{"digest 1", "digest 2", "load 1", "load 2", "square 1", "square 2"});
    CHECK(shot.report["nodes"]["top"]["frames"] == 2);
    shot.request.target.frames = FrameSet::parse("3-5", fault);
    CHECK(shot.run() == Lines{"digest 3", "digest 4", "digest 5", "load 3", "load 4", "load 5",
                              "square 3", "square 4", "square 5"});
    shot.request.target.frames.reset();
    shot.request.target = {"top", "", true};
    CHECK(shot.run() == Lines{"step 1", "step 2"});
    shot.request.target = {"save", "", true};
    shot.request.target.frames = FrameSet::parse("2", fault);
    CHECK(shot.run() == Lines{"save 2"});
    shot.request.target = {};
    shot.request.target.frames.reset();
    CHECK(shot.run() == Lines{"save 1", "save 3", "save 4", "save 5"});
    CHECK(shot.text(3) == "9 25 16 ");
}

TEST_CASE("with --only nothing else is computed: what is not there is told") {
    Shot shot;
    shot.request.target = {"top", "", true};
    CHECK(shot.run() == Lines{});
    CHECK(shot.code == exit_code::input);
    CHECK(shot.report["failures"].size() == 1);
    CHECK(shot.report["failures"][0]["message"] ==
          "has no results in the work folder for 5 of 5 frames, and --only runs no other node; run "
          "--to square first");
}

TEST_CASE("with --from only what a node leads to is delivered") {
    Shot shot;
    shot.yaml += "  raw: {type: toy.save, number: load, path: OUT/raw.##}\n";
    shot.request.target.from = "top";
    CHECK(shot.run() == everything);
    CHECK_FALSE(fs::exists(shot.folder + "/out/raw.01"));
    shot.request.target.from = "raw";
    CHECK(shot.run() == Lines{"load 1", "load 2", "load 3", "load 4", "load 5"} + saves);
}

TEST_CASE("a longer sequence reruns the new frames and what gathers them") {
    Shot shot;
    shot.run();
    shot.set(6, 6);
    shot.replace("1-5", "1-6");
    CHECK(shot.run() ==
          Lines{"digest 6", "load 6", "save 6", "square 6"} + saves + Lines{"step 1", "step 2"});
    CHECK(shot.why("load") == "input frame 6 is new");
}

TEST_CASE("estimates come from earlier runs") {
    Shot shot;
    shot.replace("number: load}", "number: load, slow_ms: 20}");
    shot.request.options.threads = 1;
    shot.run();
    CHECK(shot.forecast["unmeasured"].size() == 4);
    CHECK(shot.forecast["seconds"] == 0);
    shot.replace("slow_ms: 20", "slow_ms: 21");
    shot.run();
    CHECK(shot.forecast["unmeasured"].empty());
    CHECK(shot.forecast["seconds"].get<double>() > 0.09);
}

TEST_CASE(
    "a file that changes while the run is on is told, and nothing that was made of it is kept") {
    for (const bool cache : {true, false}) {
        INFO("cache " << cache);
        Shot shot;
        shot.request.options.cache = cache;
        shot.change_at("load 1", 4);
        CHECK(shot.code == exit_code::input);
        CHECK(shot.failures() ==
              Lines{"load 4: " + shot.folder +
                    "/in.04 was changed while the run was on; run again when its writer is done"});
        CHECK_FALSE(fs::exists(shot.folder + "/out/out.01"));
        shot.set(4, 4);
        shot.run();
        CHECK(shot.text(3) == "9 25 16 ");
    }
}

TEST_CASE(
    "a file that was read in one pass and is replaced before the next one ends a run without the "
    "cache") {
    Shot shot;
    shot.request.options.cache = false;
    for (const auto* const moment : {"step 2", "save 1"}) {
        INFO(moment);
        shot.change_at(moment, 4);
        CHECK(shot.code == exit_code::input);
        CHECK(shot.failures() ==
              Lines{"load 4: " + shot.folder +
                    "/in.04 was changed while the run was on; run again when its writer is done"});
        CHECK(shot.text(3) == "9 25 16 ");
        CHECK_FALSE(fs::exists(shot.folder + "/out/out.04"));
        shot.set(4, 4);
    }
}

TEST_CASE("a manifest lists what a run read, and a later run takes nothing else") {
    for (const bool cache : {true, false}) {
        INFO("cache " << cache);
        Shot shot;
        shot.request.options.cache = cache;
        shot.request.manifest_path = shot.folder + "/shot.manifest";
        std::ofstream(shot.folder + "/in.03") << "x";
        shot.run();
        CHECK(shot.code == exit_code::input);
        CHECK_FALSE(fs::exists(shot.request.manifest_path));
        shot.set(3, 3);
        shot.run();
        REQUIRE(shot.code == exit_code::done);
        const auto manifest = Scratch::read(shot.request.manifest_path);
        CHECK(std::ranges::count(manifest, '\n') == 6);
        fs::remove_all(shot.folder + "/out");
        shot.set(4, 9);
        const auto ran = shot.run();
        CHECK(shot.code == exit_code::input);
        CHECK(shot.failures() ==
              Lines{"load 4: " + shot.folder + "/in.04 is not the file that the manifest " +
                    shot.request.manifest_path +
                    " knows: its hash differs; restore it, or delete its line from the manifest to "
                    "accept it"});
        CHECK(std::ranges::count(ran, "load 4") == 0);
        CHECK_FALSE(fs::exists(shot.folder + "/out/out.01"));
        shot.set(4, 4);
        shot.run();
        CHECK(shot.code == exit_code::done);
        CHECK(Scratch::read(shot.request.manifest_path) == manifest);
    }
}

TEST_CASE(
    "a manifest lists the inputs of a run that computes nothing, too, and grows with chunks") {
    Shot shot;
    shot.run();
    shot.request.manifest_path = shot.folder + "/shot.manifest";
    CHECK(shot.run() == Lines{});
    const auto whole = Scratch::read(shot.request.manifest_path);
    CHECK(std::ranges::count(whole, '\n') == 6);

    fs::remove(shot.request.manifest_path);
    shot.replace("  top: {type: toy.top, number: square, count: 2}\n", "");
    shot.replace(", text: top", "");
    shot.request.options.cache = false;
    std::string fault;
    for (const auto* const chunk : {"1-2", "5", "2-4"}) {
        shot.request.target.frames = FrameSet::parse(chunk, fault);
        shot.run();
        CHECK(shot.code == exit_code::done);
    }
    CHECK(Scratch::read(shot.request.manifest_path) == whole);
}

TEST_CASE("what is remembered of former runs may be anything") {
    Shot shot;
    shot.run();
    const std::string files[] = {shot.folder + "/kept/history/p.json",
                                 shot.folder + "/kept/runs/odd.json"};
    for (
        const auto* const text :
        {"", "[1]", R"({"square": 3})",
         R"({"square": {"type": "toy.square", "params": {"times": 1}}, "nodes": {"a": 3}, "pid": "x"})",
         R"({"square": {"type": "toy.square", "version": 1, "params": {}, "inputs": {}, "files": {"x": "y"}}})",
         R"({"nodes": {}, "pid": 1.5, "started": "now"})"}) {
        INFO(text);
        for (const auto& file : files) std::ofstream(file) << text;
        fs::remove_all(shot.folder + "/out");
        CHECK(shot.run() == saves);
        CHECK(status_text(shot.folder + "/kept") != "");
    }
}
