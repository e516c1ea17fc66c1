#include "tests/support/program.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <vector>

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

const std::string plume = "tests/data/plume/plume.####.vdb";

/// Copies some frames of the plume into a folder. @return their path with a frame token
std::string plume_in(const Scratch& scratch, const std::vector<int>& frames) {
    for (const int frame : frames)
        fs::copy_file(SOURCE_ROOT "/tests/data/plume/plume.00" + std::to_string(frame) + ".vdb",
                      scratch / ("plume.00" + std::to_string(frame) + ".vdb"));
    return scratch / "plume.####.vdb";
}

/// The extent of a grid along x, before and after, in the report of a run.
std::pair<double, double> widths(const std::string& report, const std::string& node,
                                 const std::string& grid) {
    const auto entry = Json::parse(Scratch::read(report))["grids"][node][grid];
    const auto width = [&](const char* when) {
        return entry[when]["box"][1][0].get<double>() - entry[when]["box"][0][0].get<double>();
    };
    return {width("before"), width("after")};
}

}  // namespace

TEST_CASE("carve narrows a sequence with gaps in one line, and its files say how") {
    const Scratch scratch;
    const auto input = plume_in(scratch, {51, 53, 54});
    const auto ran =
        fluidcarve_program("carve " + input + " -12 -o " + (scratch / "out/c.####.vdb") +
                           " --report " + (scratch / "r.json"));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    for (const auto* const frame : {"51", "53", "54"})
        CHECK(fs::exists(scratch / (std::string("out/c.00") + frame + ".vdb")));
    CHECK_FALSE(fs::exists(scratch / "out/c.0052.vdb"));
    const auto [before, after] = widths(scratch / "r.json", "carved", "density");
    CHECK(after < before * 0.8);
    const auto made = fluidcarve_program("explain " + (scratch / "out/c.0053.vdb")).out;
    CHECK_THAT(made,
               Catch::Contains("command:  fluidcarve carve plume.####.vdb -12 -o c.####.vdb\n"));
    CHECK_THAT(made, Catch::Contains("frames: \"51,53,54\""));
}

TEST_CASE(
    "a hole in the numbers is told, files that are no frames too, and files of earlier runs among "
    "the outputs") {
    const Scratch scratch;
    const auto input = plume_in(scratch, {51, 53, 54});
    fs::copy_file(scratch / "plume.0051.vdb", scratch / "plume.0052.5.vdb");
    fs::copy_file(scratch / "plume.0051.vdb", scratch / "plume.-0001.vdb");
    fs::create_directories(scratch / "out");
    fs::copy_file(scratch / "plume.0051.vdb", scratch / "out/c.0060.vdb");
    const auto out = scratch / "out/c.####.vdb",
               carve = "carve " + input + " -4 --progress none -o " + out;
    const std::string hole = "frames: auto takes 3 frames: of 51 to 54, 52 is missing\n";
    const auto others =
        "warning: plume.-0001.vdb, plume.0052.5.vdb are no frames of " + input +
        ", and left out: a frame is a whole number with as many digits as the token "
        "says\nwarning: " +
        out +
        " has a file of frame 60 from before: this sequence does not have it, and the file stays\n";
    const auto told = fluidcarve_program(carve);
    CHECK(told.code == 0);
    CHECK_THAT(told.err, Catch::StartsWith("warning: " + hole + others + "carved: "));
    CHECK_THAT(fluidcarve_program(carve + " --missing skip").err,
               Catch::StartsWith(others + "carved: "));
    scratch.write("p.yaml", fluidcarve_program(carve + " --print-pipeline").out);
    CHECK(fluidcarve_program("check " + (scratch / "p.yaml")).err == "warning: " + hole + others);
    const auto refused = fluidcarve_program(carve + " --missing error");
    CHECK(refused.err == hole);
    CHECK(refused.code == 2);
    // On twos there is no hole.
    const auto on_twos = fluidcarve_program("carve " + plume_in(scratch, {52, 56}) + " -4 -q -o " +
                                            out + " --print-pipeline");
    CHECK(on_twos.code == 0);
    CHECK_THAT(fluidcarve_program(carve + " -f 51-54:3").err,
               Catch::StartsWith(
                   "warning: -f: 51-54:3 names all of the frames, as on a farm, where a colon only "
                   "changes their order; every n-th frame is 51-54x3\n"));
}

TEST_CASE(
    "a warp carves by fractions, seams say what to take in their place, and beside what is "
    "protected as many as there are") {
    const Scratch scratch;
    const auto carve =
        "carve tests/data/plume/plume.0051.vdb --progress none -o " + (scratch / "c.vdb");
    CHECK(fluidcarve_program(carve + " -4.5").err ==
          "seams are whole: take -5 or -4; a warp carves by fractions, too (carve --warp)\n");
    const auto warped = fluidcarve_program(carve + " -4.5 --warp --report " + (scratch / "r.json"));
    INFO(warped.err);
    REQUIRE(warped.code == 0);
    const auto [before, after] = widths(scratch / "r.json", "carved", "density");
    CHECK(before - after == Approx(4.5 / 22).margin(1.0 / 22));
    CHECK(fluidcarve_program(carve + " -4 --warp --solver greedy").err ==
          "--warp takes the place of a solver: leave --solver out\n");
    const auto guarded = fluidcarve_program(carve + " -30 --protect density=0.1");
    CHECK(guarded.code == 0);
    CHECK_THAT(guarded.err, Catch::Matches("warning: seams \\(seam.pyramid\\): finds \\d+ of 30 "
                                           "seams, as many as there is room for in [^]*"));
}

TEST_CASE("the pipeline that carve prints makes the same files") {
    const Scratch scratch;
    const auto carve = "carve " + plume +
                       " -10% --protect density=0.7 --axis y --soft 2 -f 51 -o " +
                       (scratch / "a.####.vdb");
    const auto printed = fluidcarve_program(carve + " --print-pipeline");
    INFO(printed.err);
    REQUIRE(printed.code == 0);
    CHECK_FALSE(fs::exists(scratch / "a.0051.vdb"));
    const auto work = " --work " + (scratch / "w");
    REQUIRE(fluidcarve_program(carve + work).code == 0);
    scratch.write("p.yaml", printed.out);
    REQUIRE(fluidcarve_program("run " + (scratch / "p.yaml") +
                               " -f 51 --set out=" + (scratch / "b.####.vdb") + work)
                .code == 0);
    CHECK(fluidcarve_program("diff " + (scratch / "a.0051.vdb") + " " + (scratch / "b.0051.vdb"))
              .code == 0);
}

TEST_CASE("carve makes a sequence shorter or longer in time, and says what has none") {
    const Scratch scratch;
    const auto carve = [&](const std::string& arguments) {
        return fluidcarve_program("carve " + arguments + " --axis t -o " +
                                  (scratch / "t.####.vdb"));
    };
    const auto ran = carve(plume + " -50% --progress none");
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK_THAT(ran.err, Catch::Contains("done: 3 frames in "));
    CHECK(fs::exists(scratch / "t.0053.vdb"));
    CHECK_FALSE(fs::exists(scratch / "t.0054.vdb"));
    CHECK_THAT(
        fluidcarve_program("diff tests/data/plume/plume.0056.vdb " + (scratch / "t.0053.vdb")).out,
        Catch::Contains("density: the same"));
    const auto longer = carve(plume + " 3 --solver greedy --protect density=5 --print-pipeline");
    CHECK_THAT(longer.out, Catch::StartsWith("# Lengthen smoke, in time: seams of frames are shown "
                                             "again where it shows least.\n"));
    CHECK_THAT(longer.out, Catch::Contains("seam.greedy") &&
                               Catch::Contains("protect: keep, axis: t, count: "));
    CHECK(carve("tests/data/plume/plume.0051.vdb -2").err ==
          "--axis t: one file has no frames to take or to add; give a sequence, such as "
          "smoke.####.vdb\n");
    CHECK_THAT(carve(plume + " -5").err, Catch::Contains("has room to remove 4"));
    CHECK(carve(plume + " 1e30").code == 2);
    CHECK_THAT(carve(plume + " 100% --print-pipeline").out,
               Catch::StartsWith("# Longer in time: 6 frames become 12.\n") &&
                   Catch::Contains("time.retime"));
    CHECK_THAT(carve(plume + " -2 --warp").err, Catch::StartsWith("--axis t: a warp has no time"));
    // A file is missing.
    for (const int frame : {51, 52, 54, 55})
        fs::copy_file(fmt::format("tests/data/plume/plume.{:04}.vdb", frame),
                      scratch / fmt::format("gap.{:04}.vdb", frame));
    CHECK(carve(scratch / "gap.####.vdb" + std::string(" -1 --missing error")).code == 2);
    CHECK(carve("tests/data/images/rocket.jpg -2").code == 2);
}

TEST_CASE("carve makes pictures, particles and meshes shorter or longer in time, too") {
    const Scratch scratch;
    const auto carve = [&](const std::string& files, const std::string& out) {
        const auto ran = fluidcarve_program("carve " + files + " 50% --axis t --sheet " +
                                            (scratch / "sheet.png") + " -o " + (scratch / out) +
                                            " --work " + (scratch / "work"));
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        CHECK(fs::remove(scratch / "sheet.png"));
    };
    carve("'tests/data/video/smoke.####.png'", "clip.####.png");
    CHECK(fs::exists(scratch / "clip.0068.png"));
    CHECK_FALSE(fs::exists(scratch / "clip.0069.png"));
    carve("'tests/data/river/river.####.vdb'", "river.####.vdb");
    scratch.write("bank.1.obj", Scratch::read("tests/data/river/riverbank.obj"));
    scratch.write("bank.2.obj", Scratch::read("tests/data/river/riverbank.obj"));
    CHECK_THAT(fluidcarve_program("carve tests/data/river/river.####.vdb -1 --axis t --protect "
                                  "phi=0 -o " +
                                  (scratch / "r.####.vdb"))
                   .err,
               Catch::StartsWith("--axis t changes the speed of level sets, particles and meshes"));
    carve(scratch / "bank.#.obj", "longer.#.obj");
    CHECK(Scratch::read(scratch / "longer.3.obj") == Scratch::read(scratch / "longer.1.obj"));
}

TEST_CASE("carve says that a count of nothing carves nothing") {
    const Scratch scratch;
    const auto told = [&](const std::string& arguments) {
        return fluidcarve_program("carve " + plume + " " + arguments + " -f 51 -o " +
                                  (scratch / "o.####.vdb") + " --work " + (scratch / "w"))
            .err;
    };
    // Of seams that were found before, none are taken.
    CHECK_THAT(told("-2"), !Catch::Contains("nothing is carved"));
    for (const std::string count : {"0", "0.4%"})
        CHECK_THAT(told(count), Catch::Contains("`count` comes to no seam: nothing is carved"));
    CHECK_THAT(told("-2 --warp"), !Catch::Contains("nothing is carved"));
    CHECK_THAT(told("0 --warp"), Catch::Contains("`amount` is 0, so that nothing is carved"));
}

TEST_CASE("carve --axis w goes along the axis that points up, and keeps the foot in place") {
    const auto to_text = [](const std::string& arguments) {
        return fluidcarve_program("carve " + arguments + " -10% -o x.####.vdb --print-pipeline")
            .out;
    };
    const auto lower = to_text(plume + " --axis w"), along = to_text(plume + " --axis z");
    CHECK_THAT(lower, Catch::StartsWith("# Lower smoke, along z: seams leave "));
    CHECK(lower.substr(lower.find('\n')) == along.substr(along.find('\n')));
    CHECK_THAT(to_text(plume + " --axis w"), Catch::Contains("anchor: low"));
}

TEST_CASE("carve takes images", "[long]") {
    const Scratch scratch;
    const auto ran =
        fluidcarve_program("carve tests/data/images/rocket.jpg -5% -o " + (scratch / "r.png"));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    const auto facts =
        Json::parse(fluidcarve_program("inspect --json " + (scratch / "r.png")).out)["files"][0];
    const auto before = Json::parse(
        fluidcarve_program("inspect --json tests/data/images/rocket.jpg").out)["files"][0];
    CHECK(facts["height"] == before["height"]);
    CHECK(facts["width"].get<double>() == Approx(before["width"].get<double>() * 0.95).margin(1));
}

TEST_CASE("carve says what is wrong with its words before it reads much") {
    const Scratch scratch;
    const auto wrong = [&](const std::string& arguments, int code) {
        const auto ran = fluidcarve_program("carve " + arguments);
        CHECK(ran.code == code);
        CHECK(ran.out == "");
        return ran.err;
    };
    const auto out = " -o " + (scratch / "o.####.vdb");
    CHECK(
        wrong(plume + " many" + out, 2) ==
        "COUNT must be a number of seams such as -12 or 12, or a share such as -20%, not 'many'\n");
    CHECK(wrong(plume + " -12 -o out/o.vdb", 2) ==
          "-o: " + plume +
              " is a sequence, and each frame needs a file of its own: name them as in "
              "out/plume.####.vdb\n");
    CHECK(wrong("nowhere.####.vdb -12" + out, 3) ==
          "nowhere.####.vdb: there is no file of any frame\n");
    CHECK_THAT(
        wrong(plume + " -12 --solver piramid" + out, 2),
        Catch::Contains("there is no node type 'seam.piramid'; did you mean 'seam.pyramid'?"));
    CHECK_THAT(
        wrong(plume + " -12 --protect densty=1" + out, 2),
        Catch::Contains("no float grid 'densty'") && Catch::Contains("did you mean 'density'?"));
    CHECK_THAT(wrong(plume + " -12 --protect density" + out, 2),
               Catch::Contains("'density' is neither GRID=VALUE"));
    CHECK_THAT(wrong(plume + " -12 --empty much" + out, 2),
               Catch::Contains("seam.pyramid parameter 'empty' must be a number"));
}

TEST_CASE("init writes a pipeline that passes the check, runs and narrows", "[long]") {
    const Scratch scratch;
    plume_in(scratch, {51, 52});
    const auto init = "cd " + scratch.path() +
                      " && mkdir -p shots && " FLUIDCARVE_PROGRAM
                      " init plume.####.vdb -o shots/shot.yaml";
    const auto made = call_shell(init);
    INFO(made.err);
    REQUIRE(made.code == 0);
    const auto pipeline = scratch / "shots/shot.yaml";
    // Paths start at the pipeline's folder, so that all may move together.
    CHECK_THAT(Scratch::read(pipeline), Catch::Contains("default: ../plume.####.vdb") &&
                                            Catch::Contains("\nframes: auto\n") &&
                                            Catch::Contains("profile: blender"));
    const auto checked = fluidcarve_program("check " + pipeline);
    CHECK(checked.code == 0);
    CHECK_THAT(checked.out, Catch::Contains("2 frames"));
    const auto outputs = " --set out=" + (scratch / "o.####.vdb") +
                         " --set seams=" + (scratch / "s.vdb") +
                         " --set sheet=" + (scratch / "s.png");
    REQUIRE(fluidcarve_program("run " + pipeline + outputs + " --report " + (scratch / "r.json"))
                .code == 0);
    const auto [before, after] = widths(scratch / "r.json", "carved", "density");
    CHECK(after < before * 0.9);

    const auto again = call_shell(init);
    CHECK(again.code == 2);
    CHECK(again.err == "-o: shots/shot.yaml exists already; name another file\n");
}

TEST_CASE("the rig in the comments of init may stand in place of the box") {
    const Scratch scratch;
    auto text = fluidcarve_program("init " + plume).out;
    const auto box = text.find("  box: {type: lattice.box");
    REQUIRE(box != std::string::npos);
    text.replace(box, 2, "  # ");
    for (const std::string commented : {"  # rig: {", "  # box: {type: lattice.build"}) {
        const auto at = text.find(commented);
        REQUIRE(at != std::string::npos);
        text.erase(at + 2, 2);
    }
    scratch.write("rig.yaml", text);
    const auto checked = call_shell("cp -r tests/data " + (scratch / "data") +
                                    " && " FLUIDCARVE_PROGRAM " check " + (scratch / "rig.yaml"));
    INFO(checked.err);
    CHECK(checked.code == 0);
}

TEST_CASE("init knows fire, particles and images, and takes a folder's longest sequence") {
    const auto drafted = [](const std::string& files) {
        const auto out = fluidcarve_program("init " + files);
        INFO(out.err);
        CHECK(out.code == 0);
        return out.out;
    };
    CHECK_THAT(
        drafted("tests/data/bonfire"),
        Catch::Contains("terms: [smoke, flames]") &&
            Catch::Contains("seen: {type: energy.combine, terms: [sim.density, sim.flame]}") &&
            Catch::Contains("field: seen"));
    CHECK_THAT(drafted("tests/data/river/meander.####.vdb"),
               Catch::Contains("points.write") && Catch::Contains("jitter: 0"));
    CHECK_THAT(drafted("tests/data/images/rocket.jpg"),
               Catch::Contains("image.write") && !Catch::Contains("frames:"));
    const auto many = fluidcarve_program("init tests/data/images");
    CHECK(many.code == 0);
    CHECK_THAT(many.out, Catch::Contains("tests/data/images/chelsea.png"));
    CHECK(many.err ==
          "warning: tests/data/images holds 2 sequences; this is for "
          "tests/data/images/chelsea.png, not for tests/data/images/rocket.jpg\n");
    const Scratch scratch;
    const auto carved =
        fluidcarve_program("carve tests/data/images -8 -o " + (scratch / "out.png"));
    CHECK(carved.code == 2);
    CHECK_THAT(carved.err, Catch::Contains("name one of them: "));
}

TEST_CASE(
    "carve makes particles and level sets narrower by a warp, unless told to use seams, and meshes "
    "by soft seams") {
    const Scratch scratch;
    std::string cube =
        "ply\nformat ascii 1.0\nelement vertex 4096\nproperty float x\nproperty float y\nproperty "
        "float z\nend_header\n";
    for (int x = 0; x < 16; ++x)
        for (int y = 0; y < 16; ++y)
            for (int z = 0; z < 16; ++z)
                cube += std::to_string(x / 16.0) + " " + std::to_string(y / 16.0) + " " +
                        std::to_string(z / 16.0) + "\n";
    const auto file = scratch.write("cube.ply", cube);
    const auto printed = fluidcarve_program("carve " + file + " -20% -o " + (scratch / "out.ply") +
                                            " --print-pipeline");
    CHECK_THAT(printed.out, Catch::Contains("seams: {type: warp.solve") &&
                                Catch::Contains("amount: \"${count}\"") &&
                                !Catch::Contains("soft"));
    CHECK_THAT(fluidcarve_program("carve " + file + " -20% -o " + (scratch / "out.ply") +
                                  " --solver pyramid --print-pipeline")
                   .out,
               Catch::Contains("seams: {type: seam.pyramid"));
    CHECK_THAT(fluidcarve_program("carve " + file + " -20% -o " + (scratch / "out.ply") +
                                  " --rigidity 0.1 --print-pipeline")
                   .out,
               Catch::Contains("seams: {type: seam.pyramid"));
    CHECK_THAT(fluidcarve_program("carve tests/data/plume/plume.0051.vdb -4 -o " +
                                  (scratch / "out.vdb") + " --solver warp --print-pipeline")
                   .out,
               Catch::Contains("seams: {type: warp.solve"));
    CHECK_THAT(fluidcarve_program("carve tests/data/river/riverbank.obj -20% -o " +
                                  (scratch / "out.obj") + " --print-pipeline")
                   .out,
               Catch::Contains("seams: {type: seam.pyramid") && Catch::Contains("spread: 8,") &&
                   Catch::Contains("type: remap.mesh") && Catch::Contains("soft: 12}"));
    REQUIRE(fluidcarve_program("carve " + file + " -20% -o " + (scratch / "out.ply")).code == 0);
    REQUIRE(fluidcarve_program("carve tests/data/plume/plume.0051.vdb -4 -o " +
                               (scratch / "out.vdb") + " --solver warp")
                .code == 0);
    // A warp keeps the density: an eighth and more of the particles leave.
    const auto points = [](const std::string& path) {
        const auto text = Scratch::read(path);
        return std::stoi(text.substr(text.find("element vertex ") + 15));
    };
    CHECK(points(scratch / "out.ply") < 3600);
}
