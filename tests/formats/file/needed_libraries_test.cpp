#include "formats/file/needed_libraries.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <string>

using namespace fluidcarve;

namespace {

std::string module_path(const std::string& name) {
    return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / name).string();
}

}  // namespace

TEST_CASE("the libraries behind a module come after those that they need, each once",
          "[expressions]") {
    const auto all = needed_libraries(module_path("fluidcarve_expressions.so"));
    std::set<std::string> before;
    for (const auto& library : all) {
        INFO(library);
        CHECK(std::filesystem::is_regular_file(library));
        // All that it needs is open by now, or came before.
        for (const auto& needed : needed_libraries(library)) CHECK(before.contains(needed));
        CHECK(before.insert(library).second);
    }
    const auto place_of = [&](const std::string& name) {
        return std::ranges::find_if(all,
                                    [&](const std::string& library) {
                                        return library.find(name) != std::string::npos;
                                    }) -
               all.begin();
    };
    // OpenVDB AX needs it.
    CHECK(place_of("libLLVM") < place_of("libopenvdb_ax"));
    CHECK(place_of("libopenvdb_ax") < std::ssize(all));
}

TEST_CASE("a library that is open already is not named", "[expressions]") {
    const auto all = needed_libraries(module_path("fluidcarve_expressions.so"));
    CHECK(std::ranges::none_of(all, [](const std::string& library) {
        return library.find("/libc.so") != std::string::npos;
    }));
}

TEST_CASE("what is no library needs none", "[expressions]") {
    const Scratch scratch;
    CHECK(needed_libraries(scratch / "missing.so").empty());
    CHECK(needed_libraries(scratch.write("text.so", "a text")).empty());
    auto bytes = Scratch::read(module_path("fluidcarve_expressions.so"));
    for (const std::size_t size :
         {std::size_t{20}, std::size_t{64}, std::size_t{300}, bytes.size() / 4}) {
        INFO("cut at byte " << size);
        CHECK_NOTHROW(needed_libraries(scratch.write("cut.so", bytes.substr(0, size))));
    }
}
