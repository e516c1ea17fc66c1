#include "runtime/plan/timelines.h"
#include "graph/build_pipeline.h"
#include "graph/types/node_type.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

/// Delivers each number twice.
struct Twice {
    struct Ports {
        Ref<toy::Number> number, twice;
    };
    struct Params {
        int start = 1;
    };
    std::vector<Ref<toy::Number>> all;
    static NodeTraits traits(const Params& params) {
        return {.retimes = [&params](const std::vector<int>& frames) {
            std::vector<int> out;
            for (std::size_t n = 0; n < 2 * frames.size(); ++n)
                out.push_back(params.start + static_cast<int>(n));
            return out;
        }};
    }
    void add(const Params&, const Ports& io, Context&) { all.push_back(io.number); }
    void finish(const Params&, Ports&, Context&) {}
    void run(const Params&, Ports& io, Context& context) const {
        io.twice = all.at(context.t() / 2);
    }
};

Pipeline twice_as_long(const Scratch& scratch, const std::string& nodes, std::string& problems) {
    static const Registry registry = [] {
        auto out = toy::registry();
        out.add(NodeType(Declare<Twice>("toy.twice", "Delivers each number twice.")
                             .input("number", &Twice::Ports::number, "The number.")
                             .param("start", &Twice::Params::start, Unit::frames, any_number(),
                                    "The first frame.")
                             .output("twice", &Twice::Ports::twice, "The number.")));
        return out;
    }();
    Problems found;
    auto out = build_pipeline(
        read_document(
            scratch.write(
                "p.yaml",
                "fluidcarve: 1\nframes: 3-5\nnodes:\n  load: {type: toy.load, path: in.##}\n" +
                    nodes),
            {}, found),
        registry, found);
    problems = to_text(found);
    return out;
}

}  // namespace

TEST_CASE("nodes behind one that retimes have its frames, and places count all of them") {
    const Scratch scratch;
    std::string problems;
    const auto pipeline = twice_as_long(
        scratch,
        "  twice: {type: toy.twice, number: load}\n  square: {type: toy.square, number: twice}\n",
        problems);
    REQUIRE(problems == "");
    CHECK(pipeline.frames.text() == "1-6");
    const auto node = [&](const char* name) {
        return static_cast<std::size_t>(pipeline.find(name) - pipeline.nodes.data());
    };
    const Timelines all(pipeline, {});
    CHECK(all.frames() == std::vector{1, 2, 3, 4, 5, 6});
    CHECK(all.delivered(node("load")).frames == std::vector{3, 4, 5});
    CHECK(all.input_frames(node("twice")).frames == std::vector{3, 4, 5});
    CHECK(all.delivered(node("square")).frames == std::vector{1, 2, 3, 4, 5, 6});
    CHECK_FALSE(all.delivered(node("load")).index[1]);
    CHECK(all.delivered(node("load")).index[2] == std::size_t{0});
    // What readers leave out, nodes behind the change of time still deliver.
    const Timelines some(pipeline, {4});
    CHECK(some.input_frames(node("twice")).frames == std::vector{3, 5});
    CHECK(some.delivered(node("square")).frames == std::vector{1, 2, 3, 4, 5, 6});
}

TEST_CASE("what meets in a node must have the same frames") {
    const Scratch scratch;
    std::string problems;
    twice_as_long(scratch,
                  "  twice: {type: toy.twice, number: load}\n  sum: {type: toy.add, numbers: "
                  "[load, twice]}\n",
                  problems);
    CHECK_THAT(problems,
               Catch::Contains("'load' has the frames 3-5, but 'twice' has 1-6: take both from "
                               "before the change of time, or both from behind it"));
}
