#include "runtime/tell/report.h"
#include "graph/build_pipeline.h"
#include "runtime/tell/progress.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE("what a node reports of its frames stands in their order, whichever was done first") {
    const auto registry = toy::registry();
    const Scratch scratch;
    Problems problems;
    const auto path = scratch.write(
        "p.yaml", "fluidcarve: 1\nframes: 1-6\nnodes:\n  count: {type: toy.count, path: in.##}\n");
    const auto pipeline = build_pipeline(read_document(path, {}, problems), registry, problems);
    REQUIRE(to_text(problems) == "");
    Report report(pipeline);
    for (const char* const frame : {"10", "2", "-1", "-12", "0"})
        report.entry(0, "points", {{frame, {{"moved", 1}}}});
    report.entry(0, "still", {{"all", {{"moved", 2}}}});
    report.entry(0, "shape", {{"u", 3}, {"10", 1}, {"2", 1}});
    const auto json = report.to_json({1}, 0);
    CHECK(
        json["points"]["count"].dump() ==
        R"({"-12":{"moved":1},"-1":{"moved":1},"0":{"moved":1},"2":{"moved":1},"10":{"moved":1}})");
    CHECK(json["still"]["count"].dump() == R"({"all":{"moved":2}})");
    CHECK(json["shape"]["count"].dump() == R"({"u":3,"10":1,"2":1})");
}

TEST_CASE("a warning is told while the run is on, once, and the bar makes way for it") {
    const auto registry = toy::registry();
    const Scratch scratch;
    Problems problems;
    const auto path = scratch.write(
        "p.yaml", "fluidcarve: 1\nframes: 1-6\nnodes:\n  count: {type: toy.count, path: in.##}\n");
    const auto pipeline = build_pipeline(read_document(path, {}, problems), registry, problems);
    REQUIRE(to_text(problems) == "");
    Report report(pipeline);
    CHECK(report.warn(0, "too few") == "count (toy.count): too few");
    CHECK(report.warn(0, "too few").empty());
    CHECK(report.warnings() == std::vector<std::string>{"count (toy.count): too few"});

    std::vector<std::string> said;
    Progress(ProgressStyle::none, 1, [&](const std::string& line) {
        said.push_back(line);
    }).say("now");
    Progress(ProgressStyle::none, 1).say("to nobody");
    CHECK(said == std::vector<std::string>{"now"});
}
