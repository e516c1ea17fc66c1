#include "graph/frames_of_inputs.h"
#include "graph/build_pipeline.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

/// The frames of a pipeline, or its problems without the scratch folder's name.
std::string frames_or_problems(const Scratch& scratch, const std::string& yaml) {
    static const Registry registry = toy::registry();
    Problems problems;
    const auto document = read_document(scratch.write("p.yaml", yaml), {}, problems);
    const auto pipeline = build_pipeline(document, registry, problems);
    auto text = problems.empty() ? pipeline.frames.text() : to_text(problems);
    for (std::size_t at; (at = text.find(scratch.path() + "/")) != std::string::npos;)
        text.erase(at, scratch.path().size() + 1);
    return text;
}

}  // namespace

TEST_CASE("frames: auto takes the frames that all inputs have, with their gaps") {
    const Scratch scratch;
    for (const auto* const name : {"a.01", "a.02", "a.04", "a.05", "a.5", "a.x", "b.02.txt",
                                   "b.04.txt", "b.06.txt", "rig.txt"})
        scratch.write(name, "1");
    CHECK(
        frames_or_problems(
            scratch, "fluidcarve: 1\nframes: auto\nnodes:\n  n: {type: toy.count, path: a.##}\n") ==
        "1,2,4,5");
    CHECK(frames_or_problems(scratch,
                             "fluidcarve: 1\nframes: auto\nnodes:\n  n: {type: toy.count, path: "
                             "a.##}\n  m: {type: toy.count, path: b.%02d.txt}\n"
                             "  r: {type: toy.count, path: rig.txt}\n") == "2,4");
}

TEST_CASE("frames: auto says which input has no files, and which frames inputs do not share") {
    const Scratch scratch;
    for (const auto* const name : {"a.01", "a.02", "b.07"}) scratch.write(name, "1");
    CHECK(
        frames_or_problems(
            scratch, "fluidcarve: 1\nframes: auto\nnodes:\n  n: {type: toy.count, path: c.##}\n") ==
        "p.yaml:4:30: frames: auto finds no file of any frame of c.##\n  n: {type: toy.count, "
        "path: c.##}\n                             ^\n");
    CHECK(frames_or_problems(scratch,
                             "fluidcarve: 1\nframes: auto\nnodes:\n  n: {type: toy.count, path: "
                             "a.##}\n  m: {type: toy.count, path: b.##}\n") ==
          "p.yaml:2:9: frames: auto takes the frames that all inputs have, and there is none: 'n' "
          "has 1,2, 'm' has 7\nframes: auto\n        ^\n");
    CHECK_THAT(frames_or_problems(
                   scratch,
                   "fluidcarve: 1\nframes: auto\nnodes:\n  n: {type: toy.count, path: rig.txt}\n"),
               Catch::StartsWith("p.yaml:2:9: frames: auto takes the frames whose files are there, "
                                 "but no input has a frame token such as ####"));
    CHECK_THAT(
        frames_or_problems(
            scratch, "fluidcarve: 1\nframes: auto\nnodes:\n  n: {type: toy.count, path: f.##/a}\n"),
        Catch::StartsWith("p.yaml:4:30: frames: auto looks into one folder, and f.##/a has a frame "
                          "token in its folder; name the frames"));
}

TEST_CASE("files from before do not matter to a pipeline whose writer has faults") {
    const Scratch scratch;
    CHECK_THAT(frames_or_problems(scratch,
                                  "fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n  s: "
                                  "{type: toy.save, value: n, path: '${gone}'}\n"),
               Catch::Contains("gone"));
}
