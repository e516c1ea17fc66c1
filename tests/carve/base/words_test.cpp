#include "carve/base/words.h"
#include "carve/base/one_line.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE("times, sizes and counts in words") {
    CHECK(duration_text(0.0123) == "12.3 ms");
    CHECK(duration_text(273.4) == "4.56 min");
    CHECK(size_text(512) == "512 B");
    CHECK(size_text(7890000000) == "7.89 GB");
    CHECK(counted(0, "seam") == "0 seams");
    CHECK(counted(1, "seam") == "1 seam");
}

TEST_CASE("foreign text moves no cursor and changes no colour, on one line or on several") {
    CHECK(one_line("a\nb\x1b[31m") == "a b [31m");
    CHECK(printable("two\n\tlines") == "two\n\tlines");
    CHECK(printable("a\x1b[31m\rb\x7f") == "a\\x1b[31m\\x0db\\x7f");
    CHECK(printable("\xc2\x9bm \xc3\xa4") == "\\x9bm \xc3\xa4");
}

TEST_CASE("alternatives in words") {
    CHECK(either({"a"}) == "a");
    CHECK(either({"a", "b"}) == "a or b");
    CHECK(either({"a", "b", "c"}) == "a, b or c");
}

TEST_CASE("the ending of a file's name, in small letters") {
    CHECK(ending_of("/a.b/mesh.0001.OBJ") == ".obj");
    CHECK(ending_of("a.d/mesh") == "");
    CHECK(ending_of(".ply") == "");
}
