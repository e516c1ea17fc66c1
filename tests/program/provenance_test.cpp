#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <regex>

namespace fs = std::filesystem;

namespace {

/// A plume that is carved by a few seams; what is carved is kept in the work folder.
class Shot {
public:
    explicit Shot(const std::string& top = {}) { write(top); }

    void write(const std::string& top) const {
        scratch.write(
            "p.yaml",
            "fluidcarve: 1\n" + top +
                "frames: 51-52\nparams:\n  count: {type: count, default: -3}\n  out: {type: path, "
                "default: o.####.vdb}\nnodes:\n"
                "  sim: {type: vdb.read, path: " TEST_DATA
                "/plume/plume.####.vdb, grids: {density: float}}\n"
                "  energy: {type: energy.gradient, field: sim.density}\n  box: {type: lattice.box, "
                "fit: sim.density}\n"
                "  seams: {type: seam.greedy, energy: energy, lattice: box, count: \"${count}\"}\n"
                "  carved: {type: remap.grids, source: sim, lattice: box, seams: seams, cache: "
                "true}\n"
                "  out: {type: vdb.write, source: carved, path: \"${out}\"}\n");
    }
    void run(const std::string& folder, const std::string& options = {}) const {
        const auto ran = fluidcarve_program(
            "run -q --progress none " + (scratch / "p.yaml") + " --work " + (scratch / "work") +
            " --set out=" + (scratch / folder) + "/o.####.vdb " + options);
        CHECK(ran.err == "");
        REQUIRE(ran.code == 0);
    }
    /// A frame's file, whole but for the identifier of its own that each has behind magic, versions
    /// and the offsets flag.
    std::string bytes(const std::string& folder, int frame) const {
        return Scratch::read(file(folder, frame)).erase(8 + 4 + 4 + 4 + 1, 36);
    }
    std::string file(const std::string& folder, int frame) const {
        return scratch / folder + "/o.00" + std::to_string(frame) + ".vdb";
    }

    Scratch scratch;
};

}  // namespace

TEST_CASE("explain tells what made a file, and by which command to make it again") {
    const Shot shot;
    shot.run("out", "--set count=-2 --threads 2");
    const auto path = shot.file("out", 52);
    const auto told = fluidcarve_program("explain " + path);
    CHECK(told.code == 0);
    CHECK(told.err == "");
    const auto version =
        fluidcarve_program("--version").out.substr(std::string("fluidcarve ").size());
    const std::string values =
        "{fluidcarve: 1, frames: \"51,52\", nodes: {sim: {type: vdb.read, path: plume.####.vdb, "
        "grids: {density: float}}, energy: {type: energy.gradient, "
        "field: "
        "sim.density}, box: {type: lattice.box, fit: sim.density}, seams: {type: seam.greedy, "
        "energy: energy, lattice: box, count: -2}, carved: {type: "
        "remap.grids, source: sim, lattice: box, seams: seams}, out: {type: vdb.write, source: "
        "carved}}}";
    const std::string command = "fluidcarve run p.yaml --set count=-2";
    CHECK(std::regex_replace(told.out, std::regex("xxh3-128:[0-9a-f]{32}"), "xxh3-128:HASH") ==
          path + "\n  version:  " + version + "  pipeline: p.yaml\n  values:   " + values +
              "\n  seams:    seams=xxh3-128:HASH\n  command:  " + command + "\n");
    const auto json = nlohmann::json::parse(fluidcarve_program("explain --json " + path).out);
    CHECK(json["file"] == path);
    CHECK(json["provenance"]["values"] == values);
    CHECK(json["provenance"]["command"] == command);
}

TEST_CASE("explain says that a file states nothing, or can't be read, by its code too") {
    const std::string plain = TEST_DATA "/plume/plume.0051.vdb";
    const auto nothing = fluidcarve_program("explain " + plain);
    CHECK(nothing.code == 3);
    CHECK(nothing.out == "");
    CHECK(nothing.err == plain +
                             " does not state what made it: no run of fluidcarve wrote it, or one "
                             "with 'provenance: false'\n");
    const auto json = fluidcarve_program("explain --json " + plain);
    CHECK(json.code == 3);
    CHECK(nlohmann::json::parse(json.out) ==
          nlohmann::json{{"file", plain}, {"provenance", nullptr}});
    const auto missing = fluidcarve_program("explain nowhere.vdb");
    CHECK(missing.code == 3);
    CHECK(missing.err == "failed: nowhere.vdb does not exist\n");
    const Scratch scratch;
    // What a file states reaches no terminal but as lines of text.
    const auto hostile = fluidcarve_program(
        "explain " + scratch.write("a.obj", "# fluidcarve_command: rm \033[2J\x07\nv 0 0 0\n"));
    CHECK(hostile.out == (scratch / "a.obj") + "\n  command:  rm  [2J \n");
    const auto cut = fluidcarve_program(
        "explain " + scratch.write("a.vdb", Scratch::read(plain).substr(0, 5000)));
    CHECK(cut.code == 3);
    CHECK_THAT(cut.err, Catch::StartsWith("failed: ") && Catch::Contains("a.vdb is cut off: "));
}

TEST_CASE("chunks, threads and results that are kept change no byte of what files state") {
    const Shot shot;
    shot.run("whole", "--threads 2");
    const auto whole = [&](int frame) { return shot.bytes("whole", frame); };
    shot.run("chunks", "-f 51 --threads 1 --in-flight 1 --no-cache");
    shot.run("chunks", "-f 52 --keep-going --no-cache");
    // The carved volumes come from the work folder; their seams are stated all the same.
    shot.run("kept");
    for (const int frame : {51, 52}) {
        CHECK((shot.bytes("chunks", frame) == whole(frame)));
        CHECK((shot.bytes("kept", frame) == whole(frame)));
    }
}

TEST_CASE(
    "a file is written again when its values change or its provenance is switched off, and for no "
    "comment") {
    const Shot shot;
    shot.run("out");
    // The identifier that each file has of its own tells whether it was written again.
    const auto first = Scratch::read(shot.file("out", 51));
    shot.write("# A comment.\n");
    shot.run("out");
    CHECK((Scratch::read(shot.file("out", 51)) == first));
    shot.write("provenance: false\n");
    shot.run("out");
    const auto off = Scratch::read(shot.file("out", 51));
    CHECK(fluidcarve_program("explain " + shot.file("out", 51)).code == 3);
    shot.run("out");
    CHECK((Scratch::read(shot.file("out", 51)) == off));
    shot.write("");
    shot.run("out");
    CHECK((shot.bytes("out", 51) == std::string(first).erase(8 + 4 + 4 + 4 + 1, 36)));
    shot.run("out", "--set count=-2");
    CHECK_THAT(fluidcarve_program("explain " + shot.file("out", 51)).out,
               Catch::EndsWith("  command:  fluidcarve run p.yaml --set count=-2\n"));
}

TEST_CASE("images of each format state what made them, and TIFF does not") {
    const Scratch scratch;
    const auto run = [&](const std::string& in, const std::string& out) {
        const auto path = scratch.write(
            "image.yaml",
            "fluidcarve: 1\nnodes:\n  photo: {type: image.read, path: \"" + in +
                "\"}\n  out: {type: image.write, source: photo, path: " + (scratch / out) + "}\n");
        const auto ran = fluidcarve_program("run --progress none -q " + path);
        CHECK(ran.err == "");
        CHECK(ran.code == 0);
        return fluidcarve_program("explain " + (scratch / out));
    };
    std::string in = TEST_DATA "/images/chelsea.png", name = "chelsea.png";
    for (const std::string out : {"a.png", "b.jpg", "c.png", "d.exr"}) {
        const auto told = run(in, out);
        CHECK(told.code == 0);
        // Once, though the image that was read states its own.
        CHECK_THAT(told.out,
                   Catch::Contains("\n  values:   {fluidcarve: 1, frames: 1, nodes: {photo: {type: "
                                   "image.read, path: " +
                                   name + "}, out: {type: image.write, source: photo}}}\n"));
        CHECK_THAT(told.out, Catch::Contains("\n  command:  fluidcarve run image.yaml\n"));
        in = scratch / out;
        name = out;
    }
    const auto tiff = run(in, "e.tif");
    CHECK(tiff.code == 3);
    CHECK(tiff.err == "failed: " + (scratch / "e.tif") +
                          " is no file that states what made it; those are VDB, PNG, JPEG, EXR, "
                          "PLY, OBJ and USDA files\n");
}

TEST_CASE("check and plan tell where inputs are found and where outputs go") {
    const Shot shot;
    const auto root = fs::weakly_canonical(SOURCE_ROOT).string();
    const auto files = "\nfiles:\n  sim.path is read at " TEST_DATA
                       "/plume/plume.####.vdb\n  out.path is written to " +
                       root + "/o.####.vdb\n";
    CHECK_THAT(fluidcarve_program("check -v " + (shot.scratch / "p.yaml")).out,
               Catch::EndsWith(files));
    CHECK_THAT(fluidcarve_program("plan -v " + (shot.scratch / "p.yaml")).out,
               Catch::EndsWith(files));
    CHECK_THAT(fluidcarve_program("plan " + (shot.scratch / "p.yaml")).out,
               !Catch::Contains("files:"));
    const auto json = nlohmann::json::parse(
        fluidcarve_program("check -v --json " + (shot.scratch / "p.yaml")).out);
    CHECK(json["files"]["out.path"]["path"] == root + "/o.####.vdb");
}
