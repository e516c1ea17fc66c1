#include "formats/geometry_file/obj.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace fluidcarve;

TEST_CASE("an index of OBJ counts from 1, or back from the last entry") {
    CHECK(obj_index(1, 3) == 0);
    CHECK(obj_index(3, 3) == 2);
    CHECK(obj_index(7, 3) == 6);
    CHECK(obj_index(-1, 3) == 2);
    CHECK(obj_index(-3, 3) == 0);
    for (const long none : {0L, -4L, std::numeric_limits<long>::min()}) CHECK(!obj_index(none, 3));
    CHECK(!obj_index(-1, 0));
}
