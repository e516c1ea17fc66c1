#include "graph/views/file_places.h"
#include "graph/build_pipeline.h"
#include "graph/views/value_sources.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <filesystem>

using namespace fluidcarve;

TEST_CASE(
    "inputs are told where they are found, or where they were looked for, and outputs where they "
    "go") {
    const Scratch scratch;
    const auto registry = toy::registry();
    scratch.write("in.0003.txt", "");
    const auto path = scratch.write("p.yaml", R"(fluidcarve: 1
frames: 1-4
nodes:
  count: {type: toy.count, path: in.####.txt}
  other: {type: toy.count, path: none.txt}
  last: {type: toy.count, path: /nowhere/./in.txt}
  print: {type: toy.print, number: count, path: out/../out.####.txt}
)");
    Problems problems;
    const auto document = read_document(path, {}, problems);
    const auto pipeline = build_pipeline(document, registry, problems);
    REQUIRE(to_text(problems) == "");
    const auto places = file_places(pipeline);
    const auto here = std::filesystem::current_path().string();
    CHECK(
        to_text(places) ==
        "files:\n  count.path is read at " + (scratch / "in.####.txt") +
            "\n  other.path is not found at " + (scratch / "none.txt") + ", nor at " + here +
            "/none.txt\n  last.path is not found at /nowhere/in.txt\n  print.path is written to " +
            here + "/out.####.txt\n");

    auto sources = value_sources_of(document, registry);
    const auto plain = to_text(sources);
    sources.files = places;
    CHECK(to_text(sources) == plain + "\n" + to_text(places));
    const auto json = nlohmann::json(to_json(sources))["files"];
    CHECK(json["count.path"] ==
          nlohmann::json{{"path", scratch / "in.####.txt"}, {"writes", false}, {"found", true}});
    CHECK(json["other.path"]["found"] == false);
    CHECK(json["print.path"] == nlohmann::json{{"path", here + "/out.####.txt"}, {"writes", true}});
}
