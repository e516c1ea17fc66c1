#include "formats/vdb/vdb_file.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <map>

using namespace fluidcarve;

namespace {

const std::string found = TEST_DATA "/found/";

/// What `inspect` or `carve` says of a file, without its name.
std::string said_of(const std::string& verb, const std::string& file,
                    const std::string& options = "") {
    const auto called = call_shell(
        fmt::format("cd {} && {} {} {} {}", found, FLUIDCARVE_PROGRAM, verb, file, options));
    INFO(called.out);
    CHECK(called.code == 0);
    return called.out + called.err;
}

}  // namespace

TEST_CASE(
    "volumes in the structure of public files are carved without a word of any library, and "
    "without loss") {
    const Scratch scratch;
    for (const std::string file :
         {"turned", "sheared", "same_names", "flames", "staggered", "version_225", "streamed"}) {
        INFO(file);
        const auto out = scratch / (file + ".vdb");
        const auto said =
            said_of("carve", file + ".vdb", "-20% --no-cache --progress none -o " + out);
        CHECK(said.find("WARN") == std::string::npos);
        CHECK(said.find("carved: density") != std::string::npos);
        CHECK((said.find("warning") != std::string::npos) == (file == "same_names"));
        const auto before = read_vdb(found + file + ".vdb"), after = read_vdb(out);
        REQUIRE(before.unique_names() == after.unique_names());
        for (std::size_t n = 0; n < before.grids.size(); ++n) {
            const auto &was = before.grids[n].header(), &now = after.grids[n].header();
            CHECK(was.transform() == now.transform());
            CHECK(was.saveFloatAsHalf() == now.saveFloatAsHalf());
            CHECK(now.activeVoxelCount() < was.activeVoxelCount());
        }
    }
    CHECK(read_vdb(scratch / "streamed.vdb").grids[0]->activeVoxelCount() ==
          read_vdb(scratch / "version_225.vdb").grids[0]->activeVoxelCount());
}

TEST_CASE("images in the structure of public files keep their layers, ids, depths and windows") {
    const Scratch scratch;
    const std::map<std::string, std::string> channels{
        {"layers", "ViewLayer.Depth.Z     float, 5 to 5\n  note: ViewLayer.Depth.Z: "},
        {"cryptomatte", "id                uint, 0 to 4000000001"},
        {"window", "R     half"}};
    for (const auto& [file, line] : channels) {
        INFO(file);
        const auto out = scratch / (file + ".exr");
        said_of("carve", file + ".exr", "-20% --no-cache --progress none -o " + out);
        const auto before = said_of("inspect", file + ".exr"), after = said_of("inspect", out);
        CHECK(before.find(line) != std::string::npos);
        CHECK(after.find(line) != std::string::npos);
    }
    CHECK(said_of("inspect", scratch / "cryptomatte.exr")
              .find("CryptoObject00.r  float, -4.2e+17 to 1.7e-33") != std::string::npos);
}

TEST_CASE(
    "meshes and curves in the structure of public files are read as they are meant, or refused "
    "with the remedy") {
    for (const std::string file : {"marked.obj", "scan.ply", "dimension.off"})
        CHECK(said_of("inspect", file).find("a mesh of 8 vertices and 6 faces") !=
              std::string::npos);
    CHECK(said_of("inspect", "solid.stl").find("a mesh of 8 vertices and 12 faces") !=
          std::string::npos);
    CHECK(said_of("inspect", "marked.csv").find("an open curve of 3 points") != std::string::npos);
    const auto refused =
        call_shell(fmt::format("cd {} && {} inspect utf16.obj", found, FLUIDCARVE_PROGRAM));
    CHECK(refused.code == 3);
    CHECK(refused.err == "failed: utf16.obj: the text is in UTF-16: save it in UTF-8\n");
}
