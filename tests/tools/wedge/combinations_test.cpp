#include "tools/wedge/combinations.h"

#include "carve/base/failure.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

std::string fault_of_over(const std::vector<std::string>& texts) {
    try {
        read_varied(texts);
        return {};
    } catch (const Failure& failure) {
        return failure.what();
    }
}

}  // namespace

TEST_CASE("a wedge has all combinations, and the last target varies fastest") {
    const auto varied = read_varied({"count=-4,-8", "seams.window=[1, 2],[3, 4]"});
    const auto all = combinations_of(varied);
    REQUIRE(all.size() == 4);
    CHECK(all[0] == Combination{{"count", "-4"}, {"seams.window", "[1, 2]"}});
    CHECK(all[1] == Combination{{"count", "-4"}, {"seams.window", "[3, 4]"}});
    CHECK(all[3] == Combination{{"count", "-8"}, {"seams.window", "[3, 4]"}});
    CHECK(folder_name(all[1], 2) == "02_count=-4_seams.window=_3__4_");
    CHECK(folder_name({{"out", "a/../b%04d#"}}, 1) == "01_out=a_.._b_04d_");
}

TEST_CASE("values of a wedge that say nothing or too much are told") {
    CHECK(fault_of_over({"count=-4"}).empty());
    CHECK(fault_of_over({"count"}) ==
          "--over must be PARAM=VALUE,VALUE or NODE.FIELD=VALUE,VALUE, such as count=-4,-8,-12, "
          "not 'count'");
    CHECK(fault_of_over({"count="}) ==
          "--over count: value 1 of 1 is empty; write count=VALUE,VALUE");
    CHECK(fault_of_over({"count=-4,"}) ==
          "--over count: value 2 of 2 is empty; write count=VALUE,VALUE");
    CHECK(fault_of_over({"count=-4,-8,-4"}) == "--over count: -4 is there twice; leave one out");
    CHECK(fault_of_over({"count=-4", "count=-8"}) ==
          "--over count is there twice; put all of its values into one");
    CHECK(fault_of_over({"a=1,2,3,4,5", "b=1,2,3,4,5", "c=1,2,3"}) ==
          "--over: 5 x 5 x 3 are 75 combinations, and a wedge has at most 64; name fewer values");
}
