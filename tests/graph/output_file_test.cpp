#include "graph/output_file.h"

#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace fluidcarve;

TEST_CASE("what a killed run of the same process number left aside does not stop the next") {
    const Scratch scratch;
    for (int serial = 0; serial < 100; ++serial) scratch.write(".o." + std::to_string(getpid()) + "." + std::to_string(serial) + ".part.txt", "old");
    OutputFile file(scratch / "o.txt");
    std::ofstream(file.aside()) << "new";
    file.commit();
    CHECK(Scratch::read(scratch / "o.txt") == "new");
}
