#include "runtime/run/carried_facts.h"
#include "graph/build_pipeline.h"
#include "graph/types/node_type.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <array>

using namespace fluidcarve;

namespace {

/// Lays numbers over each other.
struct Over {
    struct Ports {
        List<toy::Number> numbers;
        Ref<toy::Number> sum;
    };
    static void run(const detail::NoParams&, Ports&, Context&) {}
};

/// Hands on a number with its names.
struct Hand {
    struct Ports {
        Ref<toy::Number> number, same;
    };
    static void run(const detail::NoParams&, Ports&, Context&) {}
};

struct PlanBench {
    Registry registry = toy::registry();
    Pipeline pipeline;

    explicit PlanBench(const std::string& nodes) {
        registry.add(NodeType(Declare<Over>("toy.over", "Lays numbers over each other.")
                                  .input("numbers", &Over::Ports::numbers, "The numbers.")
                                  .output("sum", &Over::Ports::sum, "Their sum.")
                                  .in_place()));
        registry.add(NodeType(Declare<Hand>("toy.hand", "Hands on a number.")
                                  .input("number", &Hand::Ports::number, "The number.")
                                  .output("same", &Hand::Ports::same, "The same.")
                                  .names_from("number")));
        const Scratch scratch;
        Problems problems;
        pipeline = build_pipeline(
            read_document(scratch.write("p.yaml", "fluidcarve: 1\nframes: 1-2\nnodes:\n" + nodes),
                          {}, problems),
            registry, problems);
        REQUIRE(to_text(problems) == "");
    }
    std::size_t at(const std::string& name) const {
        return static_cast<std::size_t>(pipeline.find(name) - pipeline.nodes.data());
    }
};

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("sizes of pictures reach all that lies over them, and two that differ are told") {
    const PlanBench bench(
        "  photo: {type: toy.load, path: in.##}\n  paint: {type: toy.load, path: paint}\n  both: "
        "{type: toy.over, numbers: [photo, paint]}\n"
        "  next: {type: toy.over, numbers: [both]}\n  none: {type: toy.square, number: next}\n  "
        "last: {type: toy.over, numbers: [none]}\n");
    CarriedFacts facts(bench.pipeline);
    facts.deliver(bench.at("photo"), 1, "number", {Names{"R"}, std::array{4, 3}});
    facts.deliver(bench.at("photo"), 2, "number", {Names{"R"}, std::array{5, 3}});
    facts.deliver(bench.at("paint"), 1, "number", {Names{"R"}, std::array{4, 3}});
    const auto carry = [&](int frame) {
        std::string out;
        for (std::size_t n = 0; n < bench.pipeline.nodes.size(); ++n) out += facts.carry(n, frame);
        return out;
    };
    CHECK(carry(1).empty());
    const auto* const known = facts.receives(bench.at("next"), 1, "numbers");
    REQUIRE(known);
    CHECK(known->pixels == std::array{4, 3});
    CHECK_FALSE(known->grids);
    // A square says nothing of where it stands.
    REQUIRE(facts.receives(bench.at("none"), 1, "number"));
    CHECK_FALSE(facts.receives(bench.at("last"), 1, "numbers"));
    // Once, where they meet; what is behind is not known.
    CHECK(carry(2) ==
          "it lays pictures of two sizes over each other: 'photo' reads 5 x 3 pixels, but 'paint' "
          "4 x 3; scale one of them to the size of the other");
    CHECK_FALSE(facts.receives(bench.at("next"), 2, "numbers"));
}

TEST_CASE("names of grids reach only nodes behind declarations that keep them") {
    const PlanBench bench(
        "  sim: {type: toy.load, path: in.##}\n  same: {type: toy.hand, number: sim}\n  after: "
        "{type: toy.hand, number: same}\n"
        "  square: {type: toy.square, number: sim}\n  lost: {type: toy.hand, number: square}\n");
    CarriedFacts facts(bench.pipeline);
    facts.deliver(bench.at("sim"), 2, "number", {Names{"density", "flame"}, std::array{4, 3}});
    for (std::size_t n = 0; n < bench.pipeline.nodes.size(); ++n) CHECK(facts.carry(n, 2).empty());
    const auto* const known = facts.receives(bench.at("after"), 2, "number");
    REQUIRE(known);
    CHECK(known->grids == Names{"density", "flame"});
    CHECK_FALSE(known->pixels);
    CHECK_FALSE(facts.receives(bench.at("after"), 1, "number"));
    CHECK_FALSE(facts.receives(bench.at("lost"), 2, "number"));
}
