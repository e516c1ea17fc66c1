#include "carve/base/saturated.h"

#include <catch2/catch.hpp>

#include <cstdint>

using fluidcarve::saturated;

TEST_CASE("a number becomes a whole one, within its type's range, and no number becomes 0") {
    CHECK(saturated<std::int8_t>(-3.9) == -3);
    CHECK(saturated<std::uint16_t>(70'000) == 65535);
    CHECK(saturated<std::uint16_t>(-1e300) == 0);
    CHECK(saturated<std::int32_t>(INFINITY) == 2147483647);
    CHECK(saturated<std::uint32_t>(4294967295.0) == 4294967295U);
    CHECK(saturated<std::int32_t>(NAN) == 0);
}
