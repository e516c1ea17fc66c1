#include "runtime/run/steps.h"
#include "carve/base/frame_set.h"
#include "graph/build_pipeline.h"
#include "runtime/jobs/job.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <fmt/ranges.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

/// The steps of a pipeline, one line each: "top-number: --to top.number -f 1-5 after ...".
std::vector<std::string> steps_in(const std::string& nodes, const std::string& frames = "1-5",
                                  const RunTarget& wanted = {}) {
    static const Registry registry = toy::registry();
    const Scratch scratch;
    Problems problems;
    const auto path =
        scratch.write("p.yaml", "fluidcarve: 1\nframes: " + frames + "\nnodes:\n" + nodes);
    const auto pipeline = build_pipeline(read_document(path, {}, problems), registry, problems);
    REQUIRE(to_text(problems) == "");
    RunOptions options;
    options.work_folder = scratch / "work";
    Report report(pipeline);
    const Preparation prepared(pipeline, registry, {.options = options, .target = wanted}, report);
    const auto steps =
        steps_of(pipeline, prepared, History(options.work_folder, pipeline.name), options);
    std::vector<std::string> out;
    for (const auto& step : steps) {
        std::vector<std::string> needs;
        for (const auto need : step.needs) needs.push_back(steps[need].name);
        out.push_back(
            fmt::format("{}: {} {}{}{}", step.name, step.target.only ? "--only" : "--to",
                        step.target.to, step.chunked ? " -f " + FrameSet(step.frames).text() : "",
                        needs.empty() ? "" : fmt::format(" after {}", fmt::join(needs, ", "))));
    }
    return out;
}

using Lines = std::vector<std::string>;

constexpr auto solved = R"(  load: {type: toy.count, path: in.##}
  square: {type: toy.square, number: load}
  top: {type: toy.top, number: square, count: 2}
)";

std::vector<std::string> texts_of(const std::vector<FrameSet>& tasks) {
    std::vector<std::string> out;
    for (const auto& task : tasks) out.push_back(task.text());
    return out;
}

}  // namespace

TEST_CASE(
    "a run is cut into digests, solver and deliveries, and each waits for what it takes and for no "
    "more") {
    CHECK(steps_in(std::string(solved) +
                   "  save: {type: toy.save, number: square, text: top, path: out.##}\n  print: "
                   "{type: toy.print, number: load, path: raw.##}\n") ==
          Lines{"top-number: --to top.number -f 1-5", "top: --only top after top-number",
                "save: --only save -f 1-5 after top", "print: --only print -f 1-5"});
}

TEST_CASE("deliveries of one computation that is not kept share a step") {
    const auto steps = steps_in(std::string(solved) +
                                "  save: {type: toy.save, number: load, text: top, path: out.##}\n "
                                " print: {type: toy.print, number: load, path: raw.##}\n");
    REQUIRE(steps.size() == 3);
    CHECK((steps[2] == "save-print: --only save,print -f 1-5 after top" ||
           steps[2] == "print-save: --only print,save -f 1-5 after top" ||
           steps[2] == "print-save: --only save,print -f 1-5 after top"));
}

TEST_CASE(
    "what two solvers take of one result is computed in one step, and the other waits for it") {
    CHECK(steps_in(std::string(solved) +
                   "  other: {type: toy.top, number: square, offset: 1}\n  save: {type: toy.save, "
                   "number: square, text: other, path: out.##}\n") ==
          Lines{"top-number: --to top.number -f 1-5", "top: --only top after top-number",
                "other-number: --only other.number -f 1-5 after top-number",
                "other: --only other after other-number", "save: --only save -f 1-5 after other"});
}

TEST_CASE("a result that only a delivery needs is computed there") {
    CHECK(steps_in(R"(  load: {type: toy.count, path: in.##}
  square: {type: toy.square, number: load}
  save: {type: toy.save, number: square, path: out.##}
)") == Lines{"save: --to save -f 1-5"});
}

TEST_CASE("the steps are those of the part that is asked for") {
    CHECK(steps_in(solved, "-2-2", {"top.number", "", false}) ==
          Lines{"top-number: --to top.number -f -2-2"});
    CHECK(steps_in(std::string(solved) +
                       "  save: {type: toy.save, number: square, text: top, path: out.##}\n",
                   "7", {"top", "", false}) ==
          Lines{"top-number: --to top.number -f 7", "top: --only top after top-number"});
}

TEST_CASE("tasks cover each frame once, whatever the frames") {
    std::string fault;
    const auto frames = GENERATE(as<std::string>{}, "1001-1240", "1-100x3", "-5-5", "-7--3", "51",
                                 "1-20:3", "3,9,1-4");
    const auto set = *FrameSet::parse(frames, fault);
    for (const std::size_t most : {1, 3, 7, 1000}) {
        std::vector<int> covered;
        for (const auto& task : chunks_of(set, most)) {
            CHECK(task.frames().size() <= most);
            // What the command line says is what is meant.
            const auto said = FrameSet::parse(task.text(), fault);
            REQUIRE(said);
            covered.insert(covered.end(), said->frames().begin(), said->frames().end());
        }
        CHECK(covered == set.frames());
    }
    CHECK(texts_of(chunks_of(*FrameSet::parse("1-9x2", fault), 2)) == Lines{"1,3", "5,7", "9"});
}
