#include "runtime/run/forecast.h"
#include "graph/build_pipeline.h"
#include "graph/types/node_type.h"
#include "runtime/run/run.h"
#include "runtime/run/status.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace fluidcarve;

namespace {

/// Finds as many seams as are asked for, one after the other. Holds the seventh, and may be stopped
/// there.
struct Dig {
    struct Params {
        int count = 12;
        int slow_ms = 0;
        bool deep = false;
    };
    struct Ports {
        Ref<toy::Number> number;
        Ref<toy::Text> seams;
    };
    static inline std::atomic<bool> stop_at_seven{false}, stopped{false};

    void add(const Params&, const Ports&, Context&) {}
    void resume(const Payload& result, const nlohmann::ordered_json&) {
        found = result.as<toy::Text>()->value;
    }
    void finish(const Params& params, Ports& io, Context& context) {
        while (found.size() < static_cast<std::size_t>(params.count)) {
            std::this_thread::sleep_for(std::chrono::milliseconds(params.slow_ms));
            found += "|";
            if (stop_at_seven && found.size() == 7) {
                context.checkpoint(Payload(std::make_shared<toy::Text>(toy::Text{found})));
                stopped = true;
            }
            context.check_cancelled();
        }
        io.seams = std::make_shared<toy::Text>(toy::Text{found});
    }
    static Growth growth() {
        return {"count",
                [](const void*) { return std::string("removed"); },
                [](const Payload& result) {
                    return ItemCount{result.as<toy::Text>()->value.size(), 0};
                },
                [](const void* params, std::size_t) {
                    return static_cast<std::size_t>(static_cast<const Params*>(params)->count);
                },
                [](const Payload& result, std::size_t count, nlohmann::ordered_json&) {
                    return Payload(std::make_shared<toy::Text>(
                        toy::Text{result.as<toy::Text>()->value.substr(0, count)}));
                },
                nullptr,
                "seam"};
    }
    std::string found;
};

const Registry& registry_with_dig() {
    static const Registry out = [] {
        auto all = toy::registry();
        all.add(NodeType(
            Declare<Dig>("toy.dig", "Finds seams.")
                .input("number", &Dig::Ports::number, "The numbers.")
                .param("count", &Dig::Params::count, Unit::none, between(0, 100), "How many.")
                .param("slow_ms", &Dig::Params::slow_ms, Unit::none, at_least(0),
                       "Each takes so long.")
                .param("deep", &Dig::Params::deep, "Changes the result.")
                .output("seams", &Dig::Ports::seams, "The seams.")
                .grows(Dig::growth())
                .kept()));
        return all;
    }();
    return out;
}

/// A solver `dig` over five frames, behind a node `energy`, in a work folder.
class Dug {
public:
    Scratch scratch;

    Dug() {
        // What follows from files that are not there is not kept.
        for (const std::string frame : {"01", "02", "03", "04", "05"})
            scratch.write("in." + frame, frame);
    }

    Pipeline pipeline(const std::string& energy, const std::string& dig) const {
        Problems problems;
        const auto path =
            scratch.write("p.yaml",
                          "fluidcarve: 1\nframes: 1-5\nnodes:\n  count: {type: toy.count, path: "
                          "in.##}\n  energy: {type: toy.add, numbers: count" +
                              energy + "}\n  dig: {type: toy.dig, number: energy" + dig + "}\n");
        auto out = build_pipeline(read_document(path, {}, problems), registry_with_dig(), problems);
        REQUIRE(to_text(problems) == "");
        return out;
    }
    RunRequest request() const {
        RunRequest out;
        out.quiet = true;
        out.options.work_folder = scratch / "kept";
        out.report_path = scratch / "report.json";
        return out;
    }
    int run(const std::string& energy, const std::string& dig) const {
        Dig::stopped = false;
        return run_pipeline(pipeline(energy, dig), registry_with_dig(), request(),
                            [] { return Dig::stopped.load(); });
    }
    Forecast forecast(const std::string& energy, const std::string& dig, bool cache = true) const {
        const auto all = pipeline(energy, dig);
        auto options = request().options;
        options.cache = cache;
        Report unused(all);
        Preparation prepared(all, registry_with_dig(), {.options = options}, unused);
        const auto schedule = prepared.schedule();
        const History history(cache ? options.work_folder : "", all.name);
        return make_forecast(all, prepared, schedule, prepared.demands(schedule), history, options);
    }
    std::string why(const std::string& energy, const std::string& dig) const {
        return forecast(energy, dig).lines.at(2).why;
    }
};

}  // namespace

TEST_CASE("reasons name what changed, upstream first, and a count only if it is why a node runs") {
    const Dug dug;
    REQUIRE(dug.run("", ", count: 12") == exit_code::done);
    CHECK(dug.why(", offset: 1", ", count: 12") == "changed: energy");
    CHECK(dug.why(", offset: 1", ", count: 6") == "changed: energy");
    CHECK(dug.why(", offset: 1", ", count: 24, deep: true") ==
          "changed: energy; deep changed from false to true");
    CHECK(dug.why("", ", count: 6") == "");
    CHECK(dug.why("", ", count: 24") == "count changed from 12 to 24; goes on from 12 of 24 seams");
}

TEST_CASE("an interrupted solver is shown with what it has found, and goes on from there") {
    const Dug dug;
    Dig::stop_at_seven = true;
    CHECK(dug.run("", ", count: 12") == exit_code::interrupted);
    Dig::stop_at_seven = false;
    const auto status = status_text(dug.scratch / "kept");
    CHECK_THAT(status, Catch::Contains(": interrupted, "));
    CHECK_THAT(status,
               Catch::Contains(
                   "  5       0     0  5/5 frames gathered, 7/12 seams, interrupted  never run\n"));
    CHECK(dug.why("", ", count: 12") == "goes on from 7 of 12 seams");
    CHECK(dug.run("", ", count: 12") == exit_code::done);
    CHECK(dug.why("", ", count: 12") == "");
}

TEST_CASE("a time that nobody measured is not known, and is not made up") {
    const Dug dug;
    CHECK_THAT(to_text(dug.forecast("", "")),
               Catch::Contains("\ntime: not known before the first run\n"));
    CHECK_THAT(
        to_text(dug.forecast("", "", false)),
        Catch::Contains("\ntime: not known: without the work folder no run is remembered\n"));
    Dig::stop_at_seven = true;
    CHECK(dug.run("", "") == exit_code::interrupted);
    Dig::stop_at_seven = false;
    const auto text = to_text(dug.forecast("", ""));
    CHECK_THAT(text,
               Catch::Contains("\ntime: at least ") &&
                   Catch::Contains(", not counting nodes that never ran to their end: dig\n"));
}

TEST_CASE(
    "from the second run on the estimate is within two times of what the run takes, whatever the "
    "count") {
    const Dug dug;
    REQUIRE(dug.run("", ", slow_ms: 20, count: 4") == exit_code::done);
    for (const std::string changed :
         {", slow_ms: 20, count: 16", ", slow_ms: 20, count: 12, deep: true"}) {
        INFO(changed);
        const double expected = dug.forecast("", changed).seconds;
        REQUIRE(dug.run("", changed) == exit_code::done);
        const double took =
            nlohmann::json::parse(Scratch::read(dug.scratch / "report.json"))["wall_s"];
        CHECK(expected > took / 2);
        CHECK(expected < took * 2);
    }
}
