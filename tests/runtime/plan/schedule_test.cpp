#include "runtime/plan/schedule.h"
#include "graph/build_pipeline.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <fmt/ranges.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

Pipeline pipeline_of(const std::string& nodes, const Registry& registry) {
    const Scratch scratch;
    Problems problems;
    const auto path = scratch.write("p.yaml", "fluidcarve: 1\nframes: 1-2\nnodes:\n" + nodes);
    auto out = build_pipeline(read_document(path, {}, problems), registry, problems);
    REQUIRE(to_text(problems) == "");
    return out;
}

/// A line for each frame of a pass in which nodes do something.
std::string text(const Schedule& schedule, const Pipeline& pipeline) {
    std::string out;
    for (std::size_t pass = 0; pass < schedule.frames.size(); ++pass)
        for (std::size_t t = 0; t < schedule.frames[pass].size(); ++t) {
            const auto& frame = schedule.frames[pass][t];
            std::vector<std::string> does;
            for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
                const auto& name = pipeline.nodes[n].name;
                if (frame.results[n] != Schedule::Action::none)
                    does.push_back((frame.results[n] == Schedule::Action::run ? "run " : "load ") +
                                   name);
                if (frame.consumes[n] != Schedule::Consume::none)
                    does.push_back(
                        (frame.consumes[n] == Schedule::Consume::inputs ? "into " : "kept into ") +
                        name);
            }
            CHECK(frame.empty() == does.empty());
            if (!does.empty()) out += fmt::format("{}.{}: {}\n", pass, t, fmt::join(does, ", "));
        }
    return out;
}

const auto yes = [](std::size_t, std::size_t) { return true; };
const auto no = [](std::size_t, std::size_t) { return false; };

const std::string shares_of_squares = R"(  load: {type: toy.load, path: in.##}
  square: {type: toy.square, number: load}
  share: {type: toy.share, number: square}
  print: {type: toy.print, number: share, path: out.##}
)";

}  // namespace

TEST_CASE("a gathering node takes every frame in one pass, and delivers some in the next") {
    const Registry registry = toy::registry();
    const auto pipeline = pipeline_of(shares_of_squares, registry);
    const auto plan = make_plan(pipeline, {});
    const auto uncached = make_schedule(pipeline, plan, {true, false}, {no, no, yes, yes, no});
    CHECK(text(uncached, pipeline) == R"(0.0: run load, run square, into share
0.1: run load, run square, into share
1.0: run load, run square, run share, run print
)");
    CHECK(uncached.gathers == std::vector<char>{0, 0, 1, 0});
    const auto share = working_frames(uncached, 2);
    CHECK(share.run == std::set<std::size_t>{0});
    CHECK(share.consumed_inputs == std::set<std::size_t>{0, 1});
    CHECK(share.consumed_digests.empty());
    const auto load = work_of(uncached).front();
    CHECK(load.frames == 2);
    CHECK(load.runs == 3);

    // `square` is kept: the second pass loads what the first computes.
    const auto keeping = make_schedule(pipeline, plan, {true, false}, {no, no, yes, yes, yes});
    CHECK(text(keeping, pipeline) == R"(0.0: run load, run square, into share
0.1: run load, run square, into share
1.0: load square, run share, run print
)");

    const auto of_share = [](std::size_t node, std::size_t) { return node == 2; };
    const auto cached = make_schedule(pipeline, plan, {true, false}, {of_share, no, yes, yes, no});
    CHECK(text(cached, pipeline) == "1.0: load share, run print\n");
    const auto all = demands_of(pipeline, plan, cached, uncached);
    CHECK(all[1].needed == 2);
    CHECK(all[1].computed == 0);
    CHECK(all[3].needed == 1);
    CHECK(all[3].computed == 1);
}

TEST_CASE("a gathering node takes a cached digest without the frame") {
    const Registry registry = toy::registry();
    const auto pipeline = pipeline_of(
        "  load: {type: toy.load, path: in.##}\n  top: {type: toy.top, number: load, count: 1}\n",
        registry);
    const auto first = [](std::size_t, std::size_t t) { return t == 0; };
    const auto plan = make_plan(pipeline, {});
    const auto schedule = make_schedule(pipeline, plan, {true, true}, {no, first, yes, yes, no});
    CHECK(text(schedule, pipeline) == "0.0: kept into top\n0.1: run load, into top\n");
    CHECK(schedule.once[1] == Schedule::Action::run);
    const auto share =
        demands_of(pipeline, plan, schedule,
                   make_schedule(pipeline, plan, {true, true}, {no, no, yes, yes, no}))
            .at(1);
    CHECK(share.consumed_digests == 1);
    CHECK(share.consumed_inputs == 1);
    CHECK(share.needed == 2);

    const auto digests = make_plan(pipeline, {"top.number", "", false});
    const auto some = make_schedule(pipeline, digests, {false, true}, {no, no, yes, yes, no});
    CHECK(text(some, pipeline) == "0.1: run load, into top\n");
    CHECK(some.gathers == std::vector<char>{0, 0});
}

TEST_CASE(
    "a writer has what its files state the checksum of, also where all that it reads is cached") {
    const Registry registry = toy::registry();
    auto pipeline = pipeline_of(
        "  load: {type: toy.load, path: in.##}\n  square: {type: toy.square, number: load}\n"
        "  top: {type: toy.top, number: load, count: 1}\n  save: {type: toy.save, number: square, "
        "path: out.##}\n",
        registry);
    const auto plan = make_plan(pipeline, {});
    const auto top = static_cast<std::size_t>(pipeline.find("top") - pipeline.nodes.data());
    const auto save = static_cast<std::size_t>(pipeline.find("save") - pipeline.nodes.data());
    const auto known = [&](std::size_t node, std::size_t) { return node != save; };
    const auto once = [&](const auto& cached) {
        return make_schedule(pipeline, plan, {true, true}, {cached, yes, yes, yes, no}).once[top];
    };
    CHECK(once(known) == Schedule::Action::none);
    pipeline.nodes[save].checksummed = {{top, 0}};
    CHECK(once(known) == Schedule::Action::load);
    CHECK(once(yes) == Schedule::Action::none);
}
