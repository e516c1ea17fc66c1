#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#ifndef __SANITIZE_ADDRESS__

TEST_CASE("what overruns memory ends the program: all binaries are hardened") {
    const auto folder = std::filesystem::path(FLUIDCARVE_PROGRAM).parent_path();
    std::vector<std::string> binaries{FLUIDCARVE_PROGRAM};
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".so") binaries.push_back(entry.path().string());
    CHECK(binaries.size() >= 3);
    std::string symbols;
    for (const auto& binary : binaries) {
        const auto read = call_shell(fmt::format(
            "readelf --wide --file-header --program-headers --dynamic --dyn-syms {}", binary));
        REQUIRE(read.code == 0);
        INFO(binary);
        CHECK_THAT(read.out, Catch::Contains("DYN (") && Catch::Contains("GNU_RELRO") &&
                                 Catch::Contains("BIND_NOW") &&
                                 Catch::Contains("__stack_chk_fail"));
        CHECK_THAT(read.out, !Catch::Contains("RWE"));
        if (binary == FLUIDCARVE_PROGRAM) CHECK_THAT(read.out, Catch::Contains("Flags: NOW PIE"));
        symbols += read.out;
    }
    CHECK_THAT(symbols, Catch::Contains("_chk@GLIBC") && Catch::Contains("__glibcxx_assert_fail"));
}

#endif
