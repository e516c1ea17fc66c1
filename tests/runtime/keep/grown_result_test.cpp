#include "runtime/keep/grown_result.h"
#include "graph/types/node_type.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

using Json = nlohmann::ordered_json;

/// A node that wants so many of the numbers.
/// @param fewer  whether fewer are enough, if there are no more
struct Wanting {
    explicit Wanting(int count, bool fewer = false) {
        const auto params = std::make_shared<toy::Top::Params>();
        params->count = count;
        node.params = params;
        type.growth = toy::Top::growth();
        type.growth->best_effort = "fewer";
        ParamSpec spec;
        spec.name = "fewer";
        spec.text = [fewer](const void*) { return ParamTraits<bool>::text(fewer); };
        type.params.push_back(spec);
        type.growth->warnings = [](const Json& entry) {
            const auto steps = entry.at("steps").size();
            return steps > 1 ? std::vector{fmt::format("{} numbers", steps)}
                             : std::vector<std::string>();
        };
        node.type = &type;
    }
    NodeType type;
    Node node;
};

GrownResult result_of(std::size_t count, std::uint64_t bytes = 0, bool part = false) {
    return {{count, 0}, bytes, part};
}

/// A result with all items that there are.
GrownResult exhausted(std::size_t count, std::uint64_t bytes = 0) {
    return {{count, 0}, bytes, false, true};
}

}  // namespace

TEST_CASE("a header says how much of a growing result there is") {
    auto header = Json::object();
    CHECK(!GrownResult::in(header));
    GrownResult{{3, 7}, 50, true}.describe(header);
    CHECK(header.dump() == R"({"size":50,"extent":{"count":3,"of":7},"part":true})");
    const auto read = GrownResult::in(header);
    REQUIRE(read);
    CHECK(read->items.count == 3);
    CHECK(read->items.all_items == 7);
    CHECK(read->bytes == 50);
    CHECK(read->part);
    CHECK(!read->exhausted);
    auto last = Json::object();
    exhausted(3, 50).describe(last);
    CHECK(last.dump() == R"({"size":50,"extent":{"count":3,"of":0},"exhausted":true})");
    CHECK(GrownResult::in(last)->exhausted);
}

TEST_CASE(
    "a result that can't grow is enough for those who take fewer than they want, and for them "
    "alone") {
    CHECK(exhausted(2).enough_for(Wanting(5, true).node));
    CHECK(!exhausted(2).enough_for(Wanting(5).node));
    CHECK(!result_of(2).enough_for(Wanting(5, true).node));
    CHECK(exhausted(2).enough_for(Wanting(2).node));
    // What is reported with it speaks of more.
    CHECK(!exhausted(2).fits(Wanting(2).node));
    CHECK(takes_fewer(Wanting(5, true).node));
    CHECK(!takes_fewer(Wanting(5).node));
    // It takes the place of one that might grow, never the reverse.
    CHECK(!result_of(2, 10).holds(exhausted(2, 10)));
    CHECK(exhausted(2, 10).holds(result_of(2, 20)));
    CHECK(!exhausted(2, 10).holds(result_of(3, 20)));
}

TEST_CASE(
    "a result serves smaller counts, but fits only if it is complete and as large as the wanted "
    "count") {
    const Wanting two(2);
    CHECK(!result_of(1).enough_for(two.node));
    CHECK(result_of(2).enough_for(two.node));
    CHECK(result_of(3).enough_for(two.node));
    CHECK(result_of(2).fits(two.node));
    CHECK(!result_of(2, 0, true).fits(two.node));
    CHECK(!result_of(3).fits(two.node));
}

TEST_CASE("a kept result makes way for a larger one, and a part for the whole") {
    CHECK(result_of(3).holds(result_of(2)));
    CHECK(!result_of(2).holds(result_of(3)));
    CHECK(result_of(2, 10).holds(result_of(2, 10)));
    CHECK(!result_of(2, 10).holds(result_of(2, 20)));
    CHECK(!result_of(2, 10, true).holds(result_of(2, 10)));
    CHECK(result_of(2, 10, true).holds(result_of(2, 10, true)));
    CHECK(result_of(2, 10).holds(result_of(2, 10, true)));
}

TEST_CASE("a result is cut with its report entry and the warnings that depend on the count") {
    const Payload all(std::make_shared<toy::Text>(toy::Text{"9 4 1 "}));
    const NodeLog of_all{{"a small number", "3 numbers"},
                         {{"tops", Json::parse(R"({"steps":["9","4","1"]})")}}};
    const auto cut_to = [&](int count) {
        auto result = all;
        auto log = of_all;
        cut(Wanting(count).node, result_of(3), result, log);
        return std::pair(result.as<toy::Text>()->value, log);
    };
    CHECK(cut_to(3).first == "9 4 1 ");
    CHECK(cut_to(3).second.warnings == of_all.warnings);
    const auto [two, said_of_two] = cut_to(2);
    CHECK(two == "9 4 ");
    CHECK(said_of_two.warnings == std::vector<std::string>{"a small number", "2 numbers"});
    CHECK(grown_entry(said_of_two).dump() == R"({"steps":["9","4"]})");
    CHECK(cut_to(1).second.warnings == std::vector<std::string>{"a small number"});
    CHECK(grown_entry(NodeLog{}).dump() == "{}");
}
