#include "graph/views/value_sources.h"
#include "graph/build_pipeline.h"
#include "graph/pipeline.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <cstdlib>

using namespace fluidcarve;

namespace {

const Registry& registry() {
    static const Registry toys = toy::registry();
    return toys;
}

/// Of a pipeline that must be good.
ValueSources sources(const std::string& path, const std::vector<std::string>& settings = {}) {
    Problems problems;
    const auto document = read_document(path, settings, problems);
    build_pipeline(document, registry(), problems);
    INFO(to_text(problems));
    REQUIRE(problems.empty());
    return value_sources_of(document, registry());
}

/// Without the scratch folder.
std::string cut(const Scratch& scratch, std::string text) {
    for (std::size_t at; (at = text.find(scratch.path() + "/")) != std::string::npos;)
        text.erase(at, scratch.path().size() + 1);
    return text;
}

const std::string stated = R"(fluidcarve: 1
env: [FLUIDCARVE_TEST_OUT]
params:
  shot: {type: string, default: test}
  by: {type: float, default: 2.5, min: 0, max: 10}
  from: {type: path, default: in.####.txt}
  FLUIDCARVE_TEST_OUT: {type: path, default: out}
frames: 1-4
nodes:
  count: {type: toy.count, path: "${from}"}
  more:
    type: toy.add
    numbers: [count, count.number]
    offset: "${by}"
  print: {type: toy.print, number: more, path: "${FLUIDCARVE_TEST_OUT}/${shot}/${shot}.####.txt"}
)";

const std::string shot = R"(fluidcarve: 1
extends: base.yaml
params:
  shot: {default: sh010}
nodes:
  count: {fail_at: 9}
  total: {type: toy.total, number: count}
  print: {total: total}
)";

}  // namespace

TEST_CASE(
    "each value is listed with the place that states it: file, extended file, environment, command "
    "line or declaration") {
    const Scratch scratch;
    scratch.write("base.yaml", stated);
    const auto path = scratch.write("sh010.yaml", shot);
    setenv("FLUIDCARVE_TEST_OUT", "caches", 1);
    const auto found = sources(path, {"by=3", "count.late=true"});
    unsetenv("FLUIDCARVE_TEST_OUT");
    CHECK(cut(scratch, to_text(found)) == R"(frames = 1-4, from base.yaml:8

params:
  shot = sh010, from sh010.yaml:4
  by = 3, from --set
  from = in.####.txt, from base.yaml:6
  FLUIDCARVE_TEST_OUT = caches, from environment variable FLUIDCARVE_TEST_OUT

nodes:
  count:
    type = toy.count, from base.yaml:10
    path = in.####.txt, from base.yaml:6
    fail_at = 9, from sh010.yaml:6
    missing = false, default
    late = true, from --set
    skip = -1, default
  more:
    type = toy.add, from base.yaml:12
    numbers = [count, count.number], from base.yaml:13
    offset = 3, from --set
    throw_at = -1, default
  print:
    type = toy.print, from base.yaml:15
    number = more, from base.yaml:15
    total = total, from sh010.yaml:8
    path = caches/sh010/sh010.####.txt, from base.yaml:15 with FLUIDCARVE_TEST_OUT, shot
  total:
    type = toy.total, from sh010.yaml:7
    number = count, from sh010.yaml:7
    only_place = -1, default
)");
}

TEST_CASE("the same as JSON, each value as YAML") {
    const Scratch scratch;
    const auto path = scratch.write("p.yaml", R"(fluidcarve: 1
params:
  name: {type: string, default: a}
nodes:
  count: {type: toy.count, path: "in, ${name}.txt"}
)");
    CHECK(cut(scratch, to_json(sources(path)).dump(2) + "\n") == R"({
  "frames": {
    "value": "1",
    "from": "default"
  },
  "params": {
    "name": {
      "value": "a",
      "from": "p.yaml:3"
    }
  },
  "nodes": {
    "count": {
      "type": {
        "value": "toy.count",
        "from": "p.yaml:5"
      },
      "path": {
        "value": "\"in, a.txt\"",
        "from": "p.yaml:5",
        "with": [
          "name"
        ]
      },
      "fail_at": {
        "value": "-1",
        "from": "default"
      },
      "missing": {
        "value": "false",
        "from": "default"
      },
      "late": {
        "value": "false",
        "from": "default"
      },
      "skip": {
        "value": "-1",
        "from": "default"
      }
    }
  }
}
)");
}

TEST_CASE("a list tells its own place, and the names inside it once") {
    const Scratch scratch;
    const auto path = scratch.write("p.yaml", R"(fluidcarve: 1
params:
  which: {type: string, default: count}
  port: {type: string, default: number}
nodes:
  count: {type: toy.count, path: in.txt}
  more:
    type: toy.add
    numbers:
      - "${which}"
      - count.${port}
      - "${which}.${port}"
)");
    const auto found = sources(path);
    REQUIRE(found.nodes.at(1).second.at(1).first == "numbers");
    const auto& numbers = found.nodes[1].second[1].second;
    CHECK(numbers.value == "[count, count.number, count.number]");
    CHECK(cut(scratch, numbers.from) == "p.yaml:10");
    CHECK(numbers.with == std::vector<std::string>{"which", "port"});
}

TEST_CASE(
    "what a param builds on the environment is told with the param, and wherever the param is the "
    "whole value") {
    const Scratch scratch;
    const auto path = scratch.write("p.yaml", R"(fluidcarve: 1
env: [FLUIDCARVE_TEST_SHOT]
params:
  from: {type: path, default: "in/${FLUIDCARVE_TEST_SHOT}.txt"}
nodes:
  count: {type: toy.count, path: "${from}"}
  again: {type: toy.count, path: "${FLUIDCARVE_TEST_SHOT}"}
)");
    setenv("FLUIDCARVE_TEST_SHOT", "sh020", 1);
    const auto text = cut(scratch, to_text(sources(path)));
    unsetenv("FLUIDCARVE_TEST_SHOT");
    CHECK_THAT(text, Catch::Contains(
                         "\n  from = in/sh020.txt, from p.yaml:4 with FLUIDCARVE_TEST_SHOT\n"));
    CHECK_THAT(text, Catch::Contains(
                         "\n    path = in/sh020.txt, from p.yaml:4 with FLUIDCARVE_TEST_SHOT\n"));
    CHECK_THAT(text, Catch::Contains(
                         "\n    path = sh020, from environment variable FLUIDCARVE_TEST_SHOT\n"));
}

TEST_CASE("a value that YAML would read as something else is shown in quotes, and on one line") {
    const Scratch scratch;
    const auto shown = [&](const std::string& text) {
        const auto path = scratch.write(
            "p.yaml", "fluidcarve: 1\nparams:\n  text: {type: string, default: " + text +
                          "}\nnodes:\n  a: {type: toy.count, path: b}\n");
        return sources(path).params.at(0).second.value;
    };
    for (const std::string plain :
         {"sh010", "-12", "-20%", "a/b.####.vdb", "$F4", "in:out", "<frame04>", "two words"})
        CHECK(shown(plain) == plain);
    for (const std::string quoted :
         {R"("")", R"("~")", R"("null")", R"("- a")", R"("a: b")", R"("a #b")", R"("#a")",
          R"("a, b")", R"("%04d")", R"("{a}")", R"("a:")", R"(" a")", R"("a\nb")"})
        CHECK(shown(quoted) == quoted);
}
