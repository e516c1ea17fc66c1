#include "formats/file/module.h"
#include "carve/base/failure.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

using namespace fluidcarve;

TEST_CASE("a module is opened once, whoever asks first") {
    std::vector<const void*> tables(8);
    std::vector<std::thread> threads;
    for (auto& table : tables)
        threads.emplace_back([&table] { table = module_table("images", "libopenimageio-dev"); });
    for (auto& thread : threads) thread.join();
    CHECK(tables.front() != nullptr);
    CHECK(std::set<const void*>(tables.begin(), tables.end()).size() == 1);
}

TEST_CASE(
    "a folder that comes with the program is found beside it, and else told with the places where "
    "it was looked for") {
    CHECK(std::filesystem::exists(std::filesystem::path(shared_folder("python")) /
                                  "fluidcarve/worker.py"));
    const auto home = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    try {
        shared_folder("nonsense");
        FAIL("found");
    } catch (const Failure& failure) {
        CHECK(std::string(failure.what()) ==
              "there is no folder 'nonsense' of files that come with the program; looked for " +
                  (home / "nonsense").string() + ", " +
                  (home.parent_path().parent_path() / "share/fluidcarve/nonsense").string() +
                  "; build or install it with the program");
    }
}

TEST_CASE("a module that is not there is told with its place and the package that brings it") {
    const auto home = std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
    try {
        module_table("nonsense", "libnonsense-dev");
        FAIL("opened");
    } catch (const Failure& failure) {
        CHECK(std::string(failure.what()) ==
              "the module 'nonsense' is missing: there is no " + home +
                  "/fluidcarve_nonsense.so; unpack the archive 'nonsense' of this version over "
                  "fluidcarve's, or "
                  "install libnonsense-dev and build fluidcarve again");
    }
}
