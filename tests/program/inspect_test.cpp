#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace {

const std::string fire =
    "tests/data/bonfire/bonfire.####.vdb 37,38, 2 files: 2058333 to 2090561 bytes, version 224, "
    "compression blosc, as Blender writes\n"
    "  velocity     vec3s    staggered  half 142947 to 145032 voxels in [1,1,1] to [58,58,58], "
    "world [0.0266667, 0.0266667, 0.0266667] to "
    "[3.12, 3.12, 3.12], lengths 0.0769653 to 73.8295\n"
    "  density      float    fog volume half 142947 to 145032 voxels in [1,1,1] to [58,58,58], "
    "world [0.0266667, 0.0266667, 0.0266667] to "
    "[3.12, 3.12, 3.12], 1.01328e-06 to 0.392578\n"
    "  shadow       float    fog volume half     216000 voxels in [0,0,0] to [59,59,59], world "
    "[-0.0266667, -0.0266667, -0.0266667] to "
    "[3.17333, 3.17333, 3.17333], -1 to -1\n"
    "  temperature  float    fog volume half 142939 to 145020 voxels in [1,1,1] to [58,58,58], "
    "world [0.0266667, 0.0266667, 0.0266667] to "
    "[3.12, 3.12, 3.12], 1.07288e-06 to 2.22461\n"
    "  flame        float    fog volume half 18458 to 18466 voxels in [7,11,1] to [49,49,42], "
    "world [0.346667, 0.56, 0.0266667] to "
    "[2.64, 2.64, 2.26667], 0.000100136 to 0.993652\n"
    "  voxels of [0.0533333, 0.0533333, 0.0533333], the first at [0, 0, 0], UniformScaleMap "
    "(velocity, density, shadow, temperature, flame)\n"
    "  note: velocity: staggered: component c stands on the face below its voxel along axis c\n"
    "  note: velocity: its vector type is invariant: other tools don't rotate it with its "
    "transform\n"
    "  note: velocity: if Blender wrote it, in tenths of a voxel per frame, roughly\n"
    "  note: density, temperature: active only above 1e-06: derivatives jump at the border of the "
    "smoke\n"
    "  note: shadow: -1 everywhere in its box: it shows no content, so fit the lattice to another "
    "grid\n"
    "  note: the grids start at the world's origin: Blender's caches lose their place in the "
    "scene; the reader's `translate` gives it back\n"
    "  changes: flame: the box of active voxels changes from frame to frame\n";

/// What inspect prints, without what depends on the library's version.
std::string printed(const std::string& arguments) {
    auto out = fluidcarve_program("inspect " + arguments).out;
    const std::string note = "  note: the file's version is 224; it would be written as 225\n";
    if (const auto at = out.find(note); at != std::string::npos) out.erase(at, note.size());
    return out;
}

}  // namespace

TEST_CASE(
    "inspect tells a sequence as one, whether by its files, by a frame token or by its folder") {
    const auto files = fluidcarve_program(
        "inspect tests/data/bonfire/bonfire.0037.vdb tests/data/bonfire/bonfire.0038.vdb");
    CHECK(files.code == 0);
    CHECK(files.err == "");
    CHECK(printed("tests/data/bonfire/bonfire.0037.vdb tests/data/bonfire/bonfire.0038.vdb") ==
          fire);
    CHECK(printed("tests/data/bonfire/bonfire.####.vdb") == fire);
    const auto folder = fluidcarve_program("inspect tests/data/bonfire");
    CHECK(folder.code == 0);
    CHECK_THAT(printed("tests/data/bonfire"),
               Catch::StartsWith(fire + "tests/data/bonfire/firepit.obj: 26728 bytes, a mesh of "
                                        "256 vertices and 256 faces, world "
                                        "[-1.18, -1.18, 0.02] to [1.18, 1.18, 0.38]\n"));
    CHECK_THAT(folder.out,
               Catch::EndsWith("tests/data/bonfire: 1 file of another kind is not looked at\n"));
}

TEST_CASE("inspect --json keeps every file, and adds sequences and folders") {
    const auto json =
        nlohmann::json::parse(fluidcarve_program("inspect --json tests/data/bonfire").out);
    REQUIRE(json["files"].size() == 3);
    CHECK(json["files"][1]["file"] == "tests/data/bonfire/bonfire.0038.vdb");
    CHECK(json["files"][1]["frame"] == 38);
    CHECK(json["files"][2]["kind"] == "mesh");
    CHECK(json["files"][2]["vertices"] == 256);
    const auto& sequence = json["sequences"].at(0);
    CHECK(sequence["path"] == "tests/data/bonfire/bonfire.####.vdb");
    CHECK(sequence["frames"] == "37,38");
    CHECK(sequence["count"] == 2);
    const auto& flame = sequence["grids"].at(4);
    CHECK(flame["name"] == "flame");
    CHECK(flame["active_voxels"] == nlohmann::json::array({18458, 18466}));
    CHECK(flame["metadata"]["file_base_resolution"] == "[60, 60, 60]");
    CHECK_FALSE(flame["metadata"].contains("file_voxel_count"));
    CHECK(json["folders"].at(0)["other_files"] == 1);
    CHECK(json["notes"].empty());
}

TEST_CASE("inspect reads images, points and curves") {
    const Scratch scratch;
    CHECK_THAT(
        fluidcarve_program("inspect tests/data/images/chelsea.png").out,
        Catch::StartsWith(
            "tests/data/images/chelsea.png: 240512 bytes, PNG, 451 x 300 pixels\n  R     uint8, "));
    CHECK(fluidcarve_program("inspect tests/data/river/course.csv").out ==
          "tests/data/river/course.csv: 1317 bytes, an open curve of 61 points, 7.65546 long, "
          "world [0, -0.547, 0.3] to [6, 0.547, 0.48]\n");
    const std::string points =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty double age\nend_header\n0 0 1 5\n2 3 1 6\n";
    const auto path = scratch.write("drops.ply", points);
    CHECK(fluidcarve_program("inspect " + path).out ==
          path + ": " + std::to_string(points.size()) +
              " bytes, 2 points, world [0, 0, 1] to [2, 3, 1]\n  age  double\n");
}

TEST_CASE("inspect says what changes within a sequence, and what can't be read of it") {
    const Scratch scratch;
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
        "float z\n";
    const auto first =
        scratch.write("p.1.ply", head + "property double age\nend_header\n0 0 0 1\n");
    scratch.write("p.2.ply", head + "property float age\nend_header\n1 0 0 1\n");
    scratch.write("p.3.ply", head + "property float age\nproperty int id\nend_header\n1 0 4 1 7\n");
    const auto broken = scratch.write("p.4.ply", "ply\n");
    const auto ran = fluidcarve_program("inspect " + (scratch / "p.#.ply"));
    CHECK(ran.code == 3);
    CHECK_THAT(ran.err, Catch::StartsWith("failed: ") && Catch::Contains(broken));
    const auto size = [&](const char* name) {
        return std::to_string(std::filesystem::file_size(scratch / name));
    };
    CHECK(ran.out ==
          (scratch / "p.#.ply") + " 1-3, 3 files: " + size("p.2.ply") + " to " + size("p.3.ply") +
              " bytes, 1 points, world [0, 0, 0] to [1, 0, 4]\n  age  double\n  id  int\n"
              "  changes: age: type is double in frame 1, float in frames 2,3\n"
              "  changes: id: only in frame 3\n");
    const auto none = fluidcarve_program("inspect " + (scratch / "q.####.vdb"));
    CHECK(none.code == 3);
    CHECK(none.err == "failed: " + (scratch / "q.####.vdb") + ": there is no file of any frame\n");
}
