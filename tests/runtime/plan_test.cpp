#include "runtime/plan.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE("a pipeline is cut into passes at its gathering nodes, as deep as they stand behind each other") {
    const Registry registry = toy::registry();
    const Scratch scratch;
    Problems problems;
    const auto path = scratch.write("p.yaml", R"(fluidcarve: 1
frames: 1-10
nodes:
  count: {type: toy.count, path: in.##}
  fixed: {type: toy.count, path: start}
  share: {type: toy.share, number: count}
  total: {type: toy.total, number: share, start: fixed}
  early: {type: toy.print, number: count, path: early.##}
  print: {type: toy.print, number: share, total: total, path: out.##}
  last: {type: toy.print, number: total, path: total}
)");
    const auto pipeline = build_pipeline(read_document(path, {}, problems), registry, problems);
    REQUIRE(to_text(problems) == "");
    CHECK(to_text(make_plan(pipeline, ""), pipeline, 4) == path + R"(: 7 nodes, frames 1-10 (10)
once: fixed
pass 1 of 3: 10 frames
  per frame: count, early
  gathers:   share
  delivers:  early (4 frames)
pass 2 of 3: 10 frames
  per frame: count, share
  gathers:   total
once: last
pass 3 of 3: 4 frames
  per frame: count, share, print
  delivers:  print (4 frames)
)");
    CHECK(to_text(make_plan(pipeline, "last"), pipeline, 4) == path + R"(: 7 nodes, frames 1-10 (10)
once: fixed
pass 1 of 2: 10 frames
  per frame: count
  gathers:   share
pass 2 of 2: 10 frames
  per frame: count, share
  gathers:   total
once: last
)");
}
