#include "runtime/tell/profile.h"
#include "graph/build_pipeline.h"
#include "runtime/run/run.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <set>

using namespace fluidcarve;

namespace {

const Registry& toys() {
    static const Registry out = toy::registry();
    return out;
}

Pipeline pipeline_of(const Scratch& scratch) {
    Problems problems;
    for (const std::string frame : {"1", "2", "3", "4"}) scratch.write("in.0" + frame, frame);
    const auto path = scratch.write(
        "p.yaml",
        "fluidcarve: 1\nframes: 1-4\nnodes:\n  count: {type: toy.load, path: in.##}\n  square: "
        "{type: toy.square, number: count}\n"
        "  best: {type: toy.top, number: square}\n  total: {type: toy.total, number: square}\n"
        "  out: {type: toy.save, number: total, text: best, path: " +
            (scratch / "out.txt") + "}\n");
    auto out = build_pipeline(read_document(path, {}, problems), toys(), problems);
    REQUIRE(to_text(problems) == "");
    return out;
}

/// "category name frame", sorted; how often each.
std::map<std::string, int> events(const nlohmann::json& trace) {
    std::map<std::string, int> out;
    for (const auto& event : trace["traceEvents"])
        if (event["ph"] == "X")
            ++out[event["cat"].get<std::string>() + " " + event["name"].get<std::string>() +
                  (event["args"].contains("frame") ? " " + event["args"]["frame"].dump() : "")];
    return out;
}

}  // namespace

TEST_CASE("a span is an event with its thread, begin and length in microseconds") {
    const Scratch scratch;
    const auto pipeline = pipeline_of(scratch);
    RunProfile profile(pipeline);
    {
        const RunProfile::Span outer(&profile, "run", 1, 7);
        const RunProfile::Span nothing(nullptr, "run", 1, 8);
        std::this_thread::sleep_for(std::chrono::milliseconds(4));
        const RunProfile::Span inner(&profile, "keep", 1, std::nullopt);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    std::thread([&] { const RunProfile::Span other(&profile, "load", 0, 1); }).join();
    const auto trace = nlohmann::json::parse(profile.text());
    std::map<std::string, nlohmann::json> by_category;
    std::set<int> named;
    for (const auto& event : trace["traceEvents"])
        if (event["ph"] == "X") by_category[event["cat"]] = event;
        else if (event["name"] == "thread_name") named.insert(event["tid"].get<int>());
    REQUIRE(by_category.size() == 3);
    const auto &outer = by_category["run"], &inner = by_category["keep"],
               &other = by_category["load"];
    CHECK(outer["name"] == "square");
    CHECK(outer["args"] == nlohmann::json{{"type", "toy.square"}, {"frame", 7}});
    CHECK(inner["args"] == nlohmann::json{{"type", "toy.square"}});
    CHECK(outer["dur"].get<double>() >= 6000);
    CHECK(outer["dur"].get<double>() < 5e6);
    CHECK(inner["ts"].get<double>() >= outer["ts"].get<double>() + 4000);
    CHECK(inner["ts"].get<double>() + inner["dur"].get<double>() <=
          outer["ts"].get<double>() + outer["dur"].get<double>());
    CHECK(outer["tid"] == inner["tid"]);
    CHECK(outer["tid"] != other["tid"]);
    CHECK(named == std::set<int>{1, 2});
}

TEST_CASE("a run's profile has each body once per frame, and what was kept and loaded apart") {
    const Scratch scratch;
    const auto pipeline = pipeline_of(scratch);
    const auto run = [&] {
        RunRequest request;
        request.options.threads = 3;
        request.options.work_folder = scratch / "work";
        request.profile_path = scratch / "trace.json";
        request.quiet = true;
        REQUIRE(run_pipeline(pipeline, toys(), request, [] { return false; }) == 0);
        return events(nlohmann::json::parse(Scratch::read(request.profile_path)));
    };
    std::map<std::string, int> first;
    for (const std::string frame : {" 1", " 2", " 3", " 4"})
        for (const auto* const what : {"run count", "run square", "keep square", "digest best",
                                       "consume best", "consume total", "keep best"})
            first[what + frame] = 1;
    for (const auto* const what :
         {"finish best", "finish total", "run out", "keep out", "keep total"})
        first[what] = 1;
    auto told = run();
    // While it finds more, and after.
    CHECK(told["keep best"] >= 1);
    told.erase("keep best");
    told.erase("load best");
    CHECK(told == first);

    std::filesystem::remove(scratch / "out.txt");
    told = run();
    CHECK(told["load best"] == 1);
    CHECK(told["run out"] == 1);
    CHECK(told.count("run square 1") == 0);
    CHECK(told["load square 1"] == 1);
}
