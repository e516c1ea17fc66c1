#include "carve/time/loop.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace fluidcarve;

namespace {

/// Frames on a way round, once in so many.
auto around(double period) {
    return [period](std::size_t a, std::size_t b) {
        return std::abs(std::sin(M_PI * (double(a) - double(b)) / period));
    };
}

}  // namespace

TEST_CASE("the loop of a motion that repeats has its period, and room for its fade before it") {
    const auto loop = best_loop({8, 20, {}}, 40, around(16));
    CHECK(loop.length == 16);
    CHECK(loop.fade == 4);
    CHECK(loop.first >= 4);
    CHECK(loop.difference < 1e-12);
}

TEST_CASE("a loop goes round, and its last frames fade into those a length before") {
    const Loop loop{5, 8, 3, 0};
    CHECK(loop.shown(0).at == 5);
    CHECK(!loop.shown(4).fade);
    for (std::size_t n = 5; n < 8; ++n) {
        const auto shown = loop.shown(n + 16);
        CHECK(shown.at == 5 + n);
        CHECK(shown.before == 5 + n - 8);
        REQUIRE(shown.fade == n - 5);
        CHECK(shown.share == Approx(double(n - 4) / 4));
        CHECK(shown.nearer() == (n == 5 ? shown.at : shown.before));
    }
}

TEST_CASE("what would lie before the first frame of the source is that frame") {
    CHECK(Loop{2, 8, 3, 0}.shown(5).before == 0);
    CHECK(frame_before(9, 8) == 1);
    CHECK(frame_before(3, 8) == 0);
}
