#include "tests/support/program.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <filesystem>
#include <sstream>

namespace fs = std::filesystem;

// What the program does not leave to whoever starts it.

TEST_CASE("the program and its modules look for libraries in no folder that depends on where they are started") {
    const auto folder = fs::path(FLUIDCARVE_PROGRAM).parent_path();
    std::vector<std::string> binaries{FLUIDCARVE_PROGRAM};
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".so") binaries.push_back(entry.path().string());
    CHECK(binaries.size() >= 3);
    for (const auto& binary : binaries) {
        const auto read = call_shell(fmt::format("readelf -d {} | sed -n 's/.*R[UN]*PATH.*\\[\\(.*\\)\\]/\\1/p'", binary));
        REQUIRE(read.code == 0);
        INFO(binary << ": " << read.out);
        std::istringstream paths(read.out);
        std::string line;
        while (std::getline(paths, line)) {
            // A trailing separator is an empty element, too.
            std::istringstream elements(line + ":/");
            for (std::string element; std::getline(elements, element, ':');) CHECK((element.starts_with("/") || element.starts_with("$ORIGIN")));
        }
    }
}

TEST_CASE("messages reach no file of ours, even if the standard streams were closed") {
    const Scratch scratch;
    const auto run = [&](const std::string& name, const std::string& streams) {
        return call_shell(fmt::format(
            "FLUIDCARVE_WORK={} {} run pipelines/plume.yaml --set frames=51-52 --set out={}/o.####.vdb --set seams={}/s.vdb --set sheet={}/x.png {}",
            scratch / name, FLUIDCARVE_PROGRAM, scratch / name, scratch / name, scratch / name, streams));
    };
    CHECK(run("open", "").code == 0);
    CHECK(run("closed", "<&- >&- 2>&-").code == 0);
    for (const auto* const file : {"o.0051.vdb", "s.vdb", "x.png"}) CHECK(Scratch::read(scratch / "open/" + file) == Scratch::read(scratch / "closed/" + file));
    const auto told = call_shell("grep -rlaE 'frames in|done:|solving' " + (scratch / "closed"));
    CHECK(told.out.empty());
}
