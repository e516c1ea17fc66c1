#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace fs = std::filesystem;

namespace {

/// A pipeline of one program; `node` is the rest of its map.
std::string pipeline(const std::string& node) {
    return "fluidcarve: 1\nframes: 51-52\nnodes:\n  sim: {type: vdb.read, path: " TEST_DATA
           "/plume/plume.####.vdb, grids: {density: float, velocity: vector}}\n  mine:\n    type: "
           "energy.ax\n" +
           node;
}

/// What `check` says, without the folder.
std::string checked(const std::string& node) {
    const Scratch scratch;
    const auto file = scratch.write("p.yaml", pipeline(node));
    const auto out = fluidcarve_program("check " + file);
    CHECK(out.code == (out.err.empty() ? 0 : 2));
    auto text = out.err;
    for (auto at = text.find(scratch.path()); at != std::string::npos;
         at = text.find(scratch.path()))
        text.erase(at, scratch.path().size() + 1);
    return text;
}

}  // namespace

TEST_CASE("check points to what is wrong in a program, inside the pipeline file", "[expressions]") {
    const std::string inputs = "    inputs: {d: sim.density, vel: sim.velocity}\n";
    CHECK(checked(inputs + "    code: |\n      float speed = length(v@vel);\n      @energy = speed "
                           "+ 2 * @d +;\n") ==
          "p.yaml:10:33: energy.ax 'code': unexpected ';'\n"
          "      @energy = speed + 2 * @d +;\n"
          "                                ^\n");
    CHECK(checked(inputs + "    params: {gain: 2, gap: 1}\n    code: \"@energy = $gian * @d * $gap "
                           "+ length(v@vle);\"\n") ==
          "p.yaml:9:22: energy.ax 'code': '$gian' is not among the params; did you mean 'gain'?\n"
          "    code: \"@energy = $gian * @d * $gap + length(v@vle);\"\n"
          "                     ^\n"
          "p.yaml:9:49: energy.ax 'code': '@vle' is no input; did you mean 'vel'?\n"
          "    code: \"@energy = $gian * @d * $gap + length(v@vle);\"\n"
          "                                                ^\n");
    CHECK(checked(inputs + "    code: >\n      @energy = @d\n        + v@vel;\n") ==
          "p.yaml:9:7: energy.ax 'code': cannot assign a scalar value from a vector or matrix. "
          "Consider using the [] operator to get a particular element\n"
          "      @energy = @d\n"
          "      ^\n");
    CHECK(checked("    inputs: {}\n    code: \"@energy = 1;\"\n") ==
          "p.yaml:7:13: energy.ax 'inputs' names no grid; name at least one\n"
          "    inputs: {}\n"
          "            ^\n");
    CHECK(checked(inputs + "    code: \"@energy = @d + length(v@vel);\"\n").empty());
}

TEST_CASE(
    "an input that the program does not read, as while a line is left out for a try, is warned of "
    "by check and run",
    "[expressions]") {
    const Scratch scratch;
    const auto file = scratch.write(
        "p.yaml",
        pipeline("    inputs: {d: sim.density, vel: sim.velocity}\n    params: {gain: 2}\n"
                 "    code: |\n      @energy = @d;\n      // @energy += $gain * length(v@vel);\n"));
    const auto check = fluidcarve_program("check " + file);
    CHECK(check.code == 0);
    CHECK(check.err ==
          file +
              ":7:13: warning: energy.ax 'inputs' has 'vel', which the program never reads\n"
              "    inputs: {d: sim.density, vel: sim.velocity}\n"
              "            ^\n" +
              file +
              ":8:13: warning: energy.ax 'params' has 'gain', which the program never reads\n"
              "    params: {gain: 2}\n"
              "            ^\n");
    const auto json = nlohmann::json::parse(fluidcarve_program("check --json " + file).out);
    REQUIRE(json.size() == 2);
    CHECK(json[0] ==
          nlohmann::json{
              {"file", file},
              {"line", 7},
              {"column", 13},
              {"message", "warning: energy.ax 'inputs' has 'vel', which the program never reads"}});
    const auto ran = fluidcarve_program("run --progress none " + file + " --to mine --report " +
                                        (scratch / "r.json"));
    CHECK(ran.code == 0);
    CHECK_THAT(
        ran.err,
        Catch::Contains(
            "warning: mine (energy.ax): 'inputs' has 'vel', which the program never reads\n"
            "warning: mine (energy.ax): 'params' has 'gain', which the program never reads\n"));
    const auto report = nlohmann::json::parse(Scratch::read(scratch / "r.json"));
    REQUIRE(report["warnings"].size() == 2);
    CHECK(report["warnings"][1] ==
          nlohmann::json{{"node", "mine"},
                         {"message", "'params' has 'gain', which the program never reads"}});
    CHECK_THAT(fluidcarve_program("run --progress none " + file + " --to sim").err,
               !Catch::Contains("warning"));
}

TEST_CASE("a program from the command line is checked there", "[expressions]") {
    const Scratch scratch;
    const auto file = scratch.write(
        "p.yaml", pipeline("    inputs: {d: sim.density}\n    code: \"@energy = @d;\"\n"));
    const auto out =
        fluidcarve_program("check " + file + " --set 'mine.code=@energy = float(@d);'");
    CHECK(out.err ==
          "--set:1:21: energy.ax 'code': the cast is redundant: the value is float already; leave "
          "it out\n"
          "mine.code=@energy = float(@d);\n"
          "                    ^\n");
    CHECK(out.code == 2);
}

TEST_CASE("a program that reads a grid as what it is not fails with the place", "[expressions]") {
    const Scratch scratch;
    const auto file = scratch.write(
        "p.yaml", pipeline("    inputs: {vel: sim.velocity}\n    code: \"@energy = @vel;\"\n"));
    const auto out = fluidcarve_program("run -q --no-cache " + file + " --to mine");
    CHECK(out.code == 1);
    CHECK_THAT(out.err, Catch::Contains("input 'vel' holds vectors, but " + file +
                                        ":8:22 reads it as @vel; write v@vel"));
}

TEST_CASE("what needs no program needs none of its libraries", "[expressions]") {
    CHECK_THAT(call_shell("ldd " FLUIDCARVE_PROGRAM).out, !Catch::Contains("LLVM"));
    const auto opens = [](const std::string& arguments) {
        return call_shell("LD_DEBUG=files " FLUIDCARVE_PROGRAM " " + arguments)
                   .err.find("fluidcarve_expressions.so") != std::string::npos;
    };
    CHECK_FALSE(opens("nodes energy.ax"));
    CHECK_FALSE(opens("schema"));
    CHECK_FALSE(opens("check pipelines/plume.yaml"));
    CHECK(opens("check pipelines/plume_ax.yaml"));
}

TEST_CASE("without the module a program passes the check unread, and the run says what is missing",
          "[expressions]") {
    const Scratch scratch;
    fs::create_directories(scratch / "bin");
    const auto folder = fs::path(FLUIDCARVE_PROGRAM).parent_path();
    for (const auto* const file : {"fluidcarve", "libfluidcarve_graph.so"})
        fs::copy_file(folder / file, scratch / (std::string("bin/") + file));
    const auto program =
        "LD_LIBRARY_PATH=" + (scratch / "bin") + " " + (scratch / "bin/fluidcarve") + " ";
    const auto file = scratch.write(
        "p.yaml", pipeline("    inputs: {d: sim.density}\n    code: \"@energy = @d;\"\n"));
    CHECK(call_shell(program + "check " + file).code == 0);
    const auto ran = call_shell(program + "run -q --no-cache " + file + " --to mine");
    CHECK(ran.code == 1);
    CHECK_THAT(ran.err, Catch::Contains("the module 'expressions' is missing: there is no " +
                                        (scratch / "bin/fluidcarve_expressions.so")) &&
                            Catch::Contains("install libopenvdb-ax-dev"));
    fs::copy_file(folder / "fluidcarve_expressions.so", scratch / "bin/fluidcarve_expressions.so");
    CHECK(call_shell(program + "run -q --no-cache " + file + " --to mine").code == 0);
}

TEST_CASE("images and programs get along in one process", "[expressions]") {
    const Scratch scratch;
    const auto file = scratch.write(
        "p.yaml", "fluidcarve: 1\nnodes:\n  photo: {type: image.read, path: " TEST_DATA
                  "/images/chelsea.png, channels: {red: R, green: G}}\n"
                  "  mine: {type: field.ax, inputs: {r: photo.red, g: photo.green}, code: \"@out = "
                  "0.5f * (@r + @g);\"}\n"
                  "  out: {type: image.write, source: mine, path: " +
                      (scratch / "out.png") + ", depth: uint8}\n");
    CHECK(fluidcarve_program("run -q --no-cache " + file).err == "");
    CHECK(fs::exists(scratch / "out.png"));
}
