#include "carve/base/frame_set.h"

#include <catch2/catch.hpp>

using fluidcarve::even_frames;

TEST_CASE("frames in even steps, as many as a run may have, and as high as frame numbers go") {
    CHECK(even_frames(7, 3, 4) == std::vector<int>{7, 10, 13, 16});
    CHECK(even_frames(-5, 1, 1) == std::vector<int>{-5});
    CHECK(even_frames(1, 1, 0).empty());
    CHECK_THROWS_WITH(even_frames(1, 1, 1e6 + 1),
                      "that makes 1000001 frames; a million are the most");
    CHECK_THROWS_WITH(even_frames(1, 1, 1e300), Catch::EndsWith("a million are the most"));
    CHECK_THROWS_WITH(even_frames(1, 1'000'000'000, 4),
                      "that makes frames up to 3000000001; 2147483647 is the highest frame number");
}
