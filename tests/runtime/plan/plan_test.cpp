#include "runtime/plan/plan.h"
#include "graph/build_pipeline.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <fmt/ranges.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

std::string text(const Plan& plan, const Pipeline& pipeline) {
    const auto names = [&](const char* before, const std::vector<std::size_t>& nodes,
                           const char* after) {
        std::vector<std::string> out;
        for (const auto n : nodes) out.push_back(pipeline.nodes[n].name);
        return nodes.empty() ? std::string()
                             : fmt::format("{}{}{}", before, fmt::join(out, ", "), after);
    };
    std::string out;
    for (const auto& pass : plan.passes)
        out += names("once: ", pass.before, "\n") + names("pass: ", pass.per_frame, "") +
               names("; gathers ", pass.gathering, "") + names("; delivers ", pass.delivers, "") +
               "\n";
    return out + names("once: ", plan.after, "\n");
}

}  // namespace

TEST_CASE(
    "a pipeline is cut into passes at its gathering nodes, as deep as they stand behind each "
    "other") {
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
    CHECK(text(make_plan(pipeline, {}), pipeline) == R"(once: fixed
pass: count, early; gathers share; delivers early
pass: count, share; gathers total
once: last
pass: count, share, print; delivers print
)");
    CHECK(text(make_plan(pipeline, {"last", "", false}), pipeline) == R"(once: fixed
pass: count; gathers share
pass: count, share; gathers total
once: last
)");
    CHECK(text(make_plan(pipeline, {"", "total", false}), pipeline) == R"(once: fixed
pass: count; gathers share
pass: count, share; gathers total
once: last
pass: count, share, print; delivers print
)");
    CHECK(text(make_plan(pipeline, {"early", "count", false}), pipeline) ==
          "pass: count, early; delivers early\n");
    CHECK(fault_of({"shar", "", false}, pipeline) ==
          "--to: there is no node 'shar'; did you mean 'share'?");
    CHECK(fault_of({"share.number", "", false}, pipeline) ==
          "--to: 'share' (toy.share) has no output 'number', and no input that it takes frame by "
          "frame");
    CHECK(fault_of({"shar", "", true}, pipeline) ==
          "--only: there is no node 'shar'; did you mean 'share'?");
    CHECK(fault_of({"share.number", "", true}, pipeline) ==
          "--only: 'share' (toy.share) has no output 'number', and no input that it takes frame by "
          "frame");
    CHECK(fault_of({"share.share", "", false}, pipeline) == "");
    CHECK(fault_of({"", "prin", false}, pipeline) ==
          "--from: there is no node 'prin'; did you mean 'print'?");
    CHECK(fault_of({"early", "share", false}, pipeline) ==
          "--from share --to early: 'early' does not depend on 'share'");
}
