#include "runtime/run/conclusions.h"
#include "graph/build_pipeline.h"
#include "graph/types/node_type.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

/// Concludes how much all its frames weigh together.
struct Weigh {
    struct Params {
        bool fails = false;
    };
    struct Ports {
        Ref<toy::Number> number, weight;
    };
    static void run(const Params&, Ports& io, Context&) { io.weight = io.number; }
    static void conclude(const Params& params, const nlohmann::ordered_json& frames,
                         Context& context) {
        if (params.fails) throw std::runtime_error("no scales");
        double sum = 0;
        for (const auto& frame : frames) sum += frame.get<double>();
        context.tell(
            fmt::format("{} in {} of {}\nframes", sum, frames.size(), context.frames().size()));
        context.report("sums", {{"sum", sum}});
        context.warn("heavy");
    }
};

/// A pipeline with one such node, and a report in which some of its frames stand.
struct Weighing {
    explicit Weighing(const std::string& params = {}) {
        registry.add(NodeType(Declare<Weigh>("toy.weigh", "Weighs numbers.")
                                  .input("number", &Weigh::Ports::number, "The number.")
                                  .param("fails", &Weigh::Params::fails, "Fails at the end.")
                                  .output("weight", &Weigh::Ports::weight, "The number.")
                                  .concludes("weights")));
        Problems problems;
        const auto text =
            "fluidcarve: 1\nframes: 1-4\nnodes:\n  count: {type: toy.count, path: in.##}\n  weigh: "
            "{type: toy.weigh, number: count" +
            params + "}\n";
        pipeline = build_pipeline(read_document(scratch.write("p.yaml", text), {}, problems),
                                  registry, problems);
        REQUIRE(to_text(problems) == "");
        demands.resize(2);
        demands[1].needed = 3;
    }
    void conclude_of(Report& report, int frames) const {
        for (int n = 1; n <= frames; ++n)
            report.entry(1, "weights", {{std::to_string(n), n * 1.5}});
        conclude(pipeline, Timelines(pipeline, {}), demands, report);
    }

    const Scratch scratch;
    Registry registry = toy::registry();
    Pipeline pipeline;
    std::vector<fluidcarve::NodeDemand> demands;
};

}  // namespace

TEST_CASE("a node concludes from all of its frames: a line, a warning and an entry in the report") {
    const Weighing weighing;
    Report report(weighing.pipeline);
    weighing.conclude_of(report, 3);
    CHECK(report.lines() == std::vector<std::string>{"weigh: 9 in 3 of 4 frames"});
    CHECK(report.warnings() == std::vector<std::string>{"weigh (toy.weigh): heavy"});
    CHECK(report.entry_of(1, "sums").dump() == R"({"sum":9.0})");
    CHECK(report.entry_of(0, "sums").is_null());
}

TEST_CASE("a node of which frames are missing concludes nothing") {
    const Weighing weighing;
    for (const int known : {0, 2}) {
        Report report(weighing.pipeline);
        weighing.conclude_of(report, known);
        CHECK(report.lines().empty());
        CHECK(report.warnings().empty());
    }
}

TEST_CASE("a conclusion that fails is a warning, and ends no run") {
    const Weighing weighing(", fails: true");
    Report report(weighing.pipeline);
    weighing.conclude_of(report, 3);
    CHECK(report.warnings() ==
          std::vector<std::string>{
              "weigh (toy.weigh): can't say what came of its frames: no scales"});
    CHECK(report.lines().empty());
}
