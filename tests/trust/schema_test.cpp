#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>
#include "tests/support/program.h"
#include "tests/trust/program_cases.h"

namespace fs = std::filesystem;

TEST_CASE("the schema refuses pipelines that are broken, each in one place") {
    const auto ran = call_shell(R"(/usr/bin/python3 -c '
import copy, json, yaml, jsonschema
schema = jsonschema.Draft7Validator(json.load(open("pipelines/schema.json")))
good = yaml.safe_load(open("pipelines/plume.yaml"))
good["nodes"]["spin"] = {"type": "energy.vorticity", "velocity": "sim.velocity", "gain": 1}
good["nodes"]["look"] = {"type": "energy.combine", "terms": ["spin", "edges"]}
def broken(change):
    out = copy.deepcopy(good)
    change(out, out["nodes"])
    return out
def drop(of, name): del of[name]
def put(of, name, value): of[name] = value
changes = {
    "no version": lambda p, n: drop(p, "fluidcarve"),
    "another version": lambda p, n: put(p, "fluidcarve", 2),
    "no nodes": lambda p, n: drop(p, "nodes"),
    "nodes as a list": lambda p, n: put(p, "nodes", ["sim"]),
    "an unknown top field": lambda p, n: put(p, "node", {}),
    "frames that are none": lambda p, n: put(p, "frames", "a-b"),
    "a param without a type": lambda p, n: drop(p["params"]["sim"], "type"),
    "a param of no type": lambda p, n: put(p["params"]["sim"], "type", "number"),
    "a default of another type": lambda p, n: put(p["params"]["count"], "default", "many"),
    "an unknown field of a param": lambda p, n: put(p["params"]["sim"], "help", "x"),
    "a node without a type": lambda p, n: drop(n["spin"], "type"),
    "an unknown node type": lambda p, n: put(n["spin"], "type", "energy.vortex"),
    "an unknown parameter": lambda p, n: put(n["spin"], "gian", 2),
    "a missing parameter": lambda p, n: drop(n["seams"], "count"),
    "a missing input": lambda p, n: drop(n["spin"], "velocity"),
    "an input that is a list": lambda p, n: put(n["spin"], "velocity", ["sim.velocity"]),
    "an empty list of terms": lambda p, n: put(n["look"], "terms", []),
    "a text for a number": lambda p, n: put(n["spin"], "gain", "much"),
    "a number out of range": lambda p, n: put(n["spin"], "gain", -1),
    "an unknown choice": lambda p, n: put(n["seams"], "axis", "x"),
    "a vector of two": lambda p, n: put(n["sim"], "translate", [1, 2]),
    "a cache that is no bool": lambda p, n: put(n["spin"], "cache", "often"),
    "a node name with a space": lambda p, n: put(n, "my node", n["spin"]),
}
for name, change in changes.items():
    if schema.is_valid(broken(change)): print("accepted:", name)
print(len(changes), schema.is_valid(good))
')");
    CHECK(ran.err == "");
    CHECK(ran.out == "23 True\n");
}

TEST_CASE("inspect looks into files one by one: what can't be read is told, the others are shown") {
    const Scratch scratch;
    const auto whole = Scratch::read(TEST_DATA "/vdb/oiio_sphere.vdb");
    const auto cut = scratch.write("cut.vdb", whole.substr(0, 50000));
    const auto ran = fluidcarve_program("inspect " + cut + " " TEST_DATA "/vdb/oiio_sphere.vdb " +
                                        (scratch / "none.vdb"));
    CHECK(ran.code == 3);
    CHECK(ran.err == "failed: " + cut +
                         " is cut off: grid 'density' ends at byte 118012, the file at 50000; copy "
                         "or write it again\nfailed: " +
                         (scratch / "none.vdb") + " does not exist\n");
    CHECK_THAT(ran.out, Catch::StartsWith(TEST_DATA "/vdb/oiio_sphere.vdb: 118012 bytes, version "
                                                    "224, compression none, as Houdini writes\n"));

    const auto json = nlohmann::json::parse(
        fluidcarve_program("inspect --json " + cut + " " TEST_DATA "/vdb/oiio_sphere.vdb").out);
    CHECK(json["files"][0]["error"].get<std::string>().starts_with(cut));
    CHECK(json["files"][1]["grids"][0]["name"] == "density");
    const auto text = fluidcarve_program("inspect README.md");
    CHECK(text.code == 2);
    CHECK(text.err ==
          "inspect reads files that end in .vdb, .obj, .ply, .off, .stl, .csv, .png, .exr, .jpg, "
          ".jpeg, .tif, .tiff, and folders of them, not README.md\n");
}

TEST_CASE("a file that makes its reader loop or crash is damaged, and that is all") {
    // Found by build/fuzz: numbers within the grid's tree that OpenVDB trusts.
    const Scratch scratch;
    auto bytes = Scratch::read(TEST_DATA "/vdb/gaffer_arnold_sphere.vdb");
    for (std::size_t at = 700; at < 1500; at += 3) bytes[at] = '\xff';
    const auto ran = fluidcarve_program("inspect " + scratch.write("bad.vdb", bytes));
    CHECK(ran.code == 3);
    CHECK_THAT(ran.err, Catch::StartsWith("failed: " + (scratch / "bad.vdb")));
}

TEST_CASE("with a tenth of the memory energies and seams go to files, and the grids are the same") {
    const Scratch plenty;
    const Scratch scarce;
    REQUIRE(fluidcarve_program("run pipelines/plume.yaml" + into(plenty)).code == 0);
    // 42 x 42 x 86 vertices, 6 frames, 2 bytes an energy: 1.8 MB.
    REQUIRE(fluidcarve_program("run pipelines/plume.yaml --memory 180K --no-cache --work " +
                               (scarce / "work") + into(scarce))
                .code == 0);
    CHECK(fs::exists(scarce / "work"));
    CHECK(fs::is_empty(scarce / "work"));
    for (int frame = 51; frame <= 56; ++frame)
        CHECK(same_but_identifier(plenty, scarce, "out.00" + std::to_string(frame) + ".vdb"));
}

TEST_CASE(
    "the program and its modules look for libraries in no folder that depends on where they are "
    "started") {
    const auto folder = fs::path(FLUIDCARVE_PROGRAM).parent_path();
    std::vector<std::string> binaries{FLUIDCARVE_PROGRAM};
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".so") binaries.push_back(entry.path().string());
    CHECK(binaries.size() >= 3);
    for (const auto& binary : binaries) {
        const auto read = call_shell(
            fmt::format("readelf -d {} | sed -n 's/.*R[UN]*PATH.*\\[\\(.*\\)\\]/\\1/p'", binary));
        REQUIRE(read.code == 0);
        INFO(binary << ": " << read.out);
        std::istringstream paths(read.out);
        std::string line;
        while (std::getline(paths, line)) {
            // A trailing separator is an empty element, too.
            std::istringstream elements(line + ":/");
            for (std::string element; std::getline(elements, element, ':');)
                CHECK((element.starts_with("/") || element.starts_with("$ORIGIN")));
        }
    }
}

TEST_CASE("messages reach no file of ours, even if the standard streams were closed") {
    const Scratch scratch;
    const auto ran =
        call_shell(fmt::format("FLUIDCARVE_WORK={0}/w {1} run pipelines/plume.yaml --set "
                               "frames=51-52 --set out={0}/o.####.vdb --set seams={0}/s.vdb "
                               "--set sheet={0}/x.png <&- >&- 2>&-",
                               scratch.path(), FLUIDCARVE_PROGRAM));
    CHECK(ran.code == 0);
    CHECK(fs::exists(scratch / "o.0052.vdb"));
    CHECK(call_shell("grep -rlaE 'frames in|done:|solving' " + scratch.path()).out.empty());
}
