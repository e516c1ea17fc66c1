#include "carve/time/frame_carve_promise.h"

#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;

TEST_CASE("the frames that a carve leaves are numbered on, and more than there are can't go") {
    const auto left = [](const FrameCarvePromise& carved, const Auto<Count>& used,
                         const std::vector<int>& frames) { return carved.left(used, frames); };
    CHECK(left({{-1}}, {}, {11, 13, 15}) == std::vector{11, 13});
    CHECK(left({{1}}, {}, {11, 13, 15}) == std::vector{11, 13, 15, 17});
    CHECK(left({{-2}}, Count{1}, {1, 2, 3}) == std::vector{1, 2});
    CHECK(left({{2}}, Count{1}, {1, 2, 3}) == std::vector{1, 2, 3, 4});
    CHECK(left({{-2}, true}, {}, {1, 2, 3}) == std::vector{1, 2, 3});
    CHECK(left({{-50, true}}, {}, {1, 2, 3, 4}) == std::vector{1, 2});
    CHECK(failure_of([&] {
              left({{-3}}, {}, {1, 2, 3});
          }) == "count -3 takes all of 3 frames; some must stay");
    CHECK(failure_of([&] { left({{-1}}, {}, {1, 2, 4}); }) != "");
}
