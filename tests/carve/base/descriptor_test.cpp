#include "carve/base/descriptor.h"

#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <string>

using namespace fluidcarve;

TEST_CASE("bytes are written and read at their place, and a file that ends before is told") {
    const Scratch scratch;
    const Descriptor file(open((scratch / "a").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
    REQUIRE(file.number >= 0);
    const std::string early = "seam", late = "lattice";
    REQUIRE(write_at(file.number, 10, late.data(), late.size()));
    REQUIRE(write_at(file.number, 0, early.data(), early.size()));

    std::string out(7, ' ');
    REQUIRE(read_at(file.number, 10, out.data(), 7));
    CHECK(out == "lattice");
    REQUIRE(read_at(file.number, 0, out.data(), 4));
    CHECK(out == "seamice");
    CHECK_FALSE(read_at(file.number, 11, out.data(), 7));
    CHECK_FALSE(read_at(-1, 0, out.data(), 1));
    CHECK_FALSE(write_at(-1, 0, out.data(), 1));
}

TEST_CASE("a descriptor closes its file at the end of its scope") {
    int number = -1;
    {
        const Descriptor file(open("/dev/null", O_RDONLY | O_CLOEXEC));
        number = file.number;
        REQUIRE(fcntl(number, F_GETFD) >= 0);
    }
    CHECK(fcntl(number, F_GETFD) < 0);
}
