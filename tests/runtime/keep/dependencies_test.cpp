#include "runtime/keep/dependencies.h"
#include "graph/build_pipeline.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE("a result depends on parameters, inputs and what is in files, not on their paths") {
    const Registry registry = toy::registry();
    const Scratch scratch;
    Problems problems;
    const auto path = scratch.write("p.yaml", R"(fluidcarve: 1
frames: 1-2
nodes:
  load: {type: toy.load, path: in.##}
  top: {type: toy.top, number: load, count: 3}
)");
    const auto pipeline = build_pipeline(read_document(path, {}, problems), registry, problems);
    REQUIRE(to_text(problems) == "");
    const Timelines timelines(pipeline, {});
    const std::map<std::size_t, std::map<int, int>> stands_in{{0, {{2, 1}}}}, nothing;
    FileHashes files("");
    const Dependencies dependencies(pipeline, timelines, stands_in, files);

    const auto of_load = dependencies.of(0), of_top = dependencies.of(1);
    CHECK(of_load.type == "toy.load");
    CHECK(of_load.params.empty());
    CHECK(of_load.inputs.empty());
    CHECK(!of_load.plugin);
    REQUIRE(of_top.params.size() == 2);
    CHECK(of_top.params[0].name == "count");
    CHECK(of_top.params[0].text == "3");
    CHECK(of_top.params[0].rest == "largest");
    CHECK(of_top.params[1].rest == of_top.params[1].text);
    REQUIRE(of_top.inputs.size() == 1);
    CHECK(of_top.inputs[0].name == "number");
    CHECK(of_top.inputs[0].source == 0);
    CHECK(of_top.inputs[0].output == "number");

    CHECK(dependencies.files(0, 0) == dependencies.files(0, 1));
    CHECK(dependencies.files(1, 0).empty());
    CHECK(dependencies.watched_files(0, 0) == std::vector{scratch / "in.01"});
    CHECK(dependencies.watched_files(0, 1) == std::vector{scratch / "in.01", scratch / "in.02"});
    CHECK(!dependencies.contents(0, 0));
    scratch.write("in.01", "7");
    FileHashes later("");
    const Dependencies then(pipeline, timelines, nothing, later);
    CHECK(then.contents(0, 0));
    CHECK(!then.contents(0, 1));
}
