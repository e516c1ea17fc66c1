#include "graph/types/outlook.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE("regions meet if any of their boxes touch") {
    const Region::Box low{{0, 0, 0}, {1, 1, 1}}, beside{{1, 0.5, 0.5}, {2, 2, 2}},
        far{{0, 0, 1.1}, {1, 1, 2}};
    CHECK(meet({low}, {beside}));
    CHECK(!meet({low}, {far}));
    CHECK(!meet({far}, {low}));
    CHECK(meet({low}, {far, beside}));
    CHECK(!meet({low}, {}));
}

TEST_CASE("a region is widened with all that it could be, and told by the box around it") {
    const Region region{{{{0, 0, 0}, {1, 1, 1}}, {{2, -3, 0.5}, {2, 4, 0.5}}},
                        {{"otherwise", {{{7, 7, 7}, {8, 8, 8}}}}}};
    const auto out = widened(region, 0.5);
    CHECK(to_text(around(region.boxes)) == "(0, -3, 0) to (2, 4, 1)");
    CHECK(to_text(around(out.boxes)) == "(-0.5, -3.5, -0.5) to (2.5, 4.5, 1.5)");
    REQUIRE(out.otherwise.size() == 1);
    CHECK(out.otherwise[0].how == "otherwise");
    CHECK(to_text(out.otherwise[0].boxes.at(0)) == "(6.5, 6.5, 6.5) to (8.5, 8.5, 8.5)");
}
