#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace fs = std::filesystem;

namespace {

std::string pipeline(const std::string& in, const std::string& out) {
    return "fluidcarve: 1\nframes: 1-3\nnodes:\n  photo: {type: image.read, path: \"" + in +
           "\"}\n  out: {type: image.write, source: photo, path: \"" + out + "\"}\n";
}

}  // namespace

TEST_CASE("the program starts without the libraries of its modules", "[images]") {
    CHECK_THAT(call_shell("ldd " FLUIDCARVE_PROGRAM).out, !Catch::Contains("OpenImageIO"));
}

TEST_CASE("a module that is missing stops the run that needs it, not the program", "[images]") {
    const Scratch scratch;
    fs::create_directories(scratch / "bin");
    fs::copy_file(FLUIDCARVE_PROGRAM, scratch / "bin/fluidcarve");
    // Libraries are found where they were built; so is the module, unless the library is a copy as
    // well.
    const auto folder = fs::path(FLUIDCARVE_PROGRAM).parent_path();
    fs::copy_file(folder / "libfluidcarve_graph.so", scratch / "bin/libfluidcarve_graph.so");
    const auto program =
        "LD_LIBRARY_PATH=" + (scratch / "bin") + " " + (scratch / "bin/fluidcarve") + " ";
    const auto file =
        scratch.write("p.yaml", pipeline(TEST_DATA "/images/chelsea.png", scratch / "out.png"));
    CHECK(call_shell(program + "check " + file).code == 0);
    CHECK(call_shell(program + "nodes image.read").code == 0);
    const auto ran = call_shell(program + "run -q " + file);
    CHECK(ran.code != 0);
    CHECK_THAT(ran.err,
               Catch::Contains("the module 'images' is missing: there is no " +
                               (scratch / "bin/fluidcarve_images.so") + "; unpack the archive") &&
                   Catch::Contains("install libopenimageio-dev"));
    fs::copy_file(folder / "fluidcarve_images.so", scratch / "bin/fluidcarve_images.so");
    CHECK(call_shell(program + "run -q " + file).code == 0);
}

TEST_CASE("a share of an image's width is rounded to whole seams", "[images]") {
    const Scratch scratch;
    const auto seams = [&](const std::string& count) {
        const auto ran =
            fluidcarve_program("run -q pipelines/image.yaml --to seams --set photo=" TEST_DATA
                               "/images/chelsea.png --set count=" +
                               count + " --report " + (scratch / "report.json"));
        REQUIRE(ran.err == "");
        return nlohmann::json::parse(
                   Scratch::read(scratch / "report.json"))["seams"]["seams"]["energy"]
            .size();
    };
    // Of 451 pixels.
    CHECK(seams("-2%") == 9);
    CHECK(seams("2%") == 9);
    CHECK(seams("-0.1%") == 0);
    CHECK(seams("-0.7%") == 3);
}

TEST_CASE("a painted image is a mask: what is bright in it no seam passes", "[images]") {
    const Scratch scratch;
    const auto energy = [&](const std::string& more) {
        const auto file = scratch.write("p.yaml", "fluidcarve: 1\nextends: " SOURCE_ROOT
                                                  "/pipelines/image.yaml\nnodes:\n" +
                                                      more);
        const auto ran = fluidcarve_program("run -q " + file +
                                            " --to seams --set photo=" TEST_DATA
                                            "/images/chelsea.png --set count=-3 --report " +
                                            (scratch / "report.json"));
        REQUIRE(ran.err == "");
        return nlohmann::json::parse(Scratch::read(scratch / "report.json"))["seams"]["seams"];
    };
    const auto free = energy("  box: {fit: energy}\n");
    const auto kept = energy("  paint: {type: image.read, path: " TEST_DATA
                             "/images/chelsea.png, channels: {red: R}}\n"
                             "  bright: {type: mask.threshold, field: paint.red, above: 0.75}\n  "
                             "seams: {protect: bright}\n");
    CHECK(kept["protected"] == nlohmann::json({0, 0, 0}));
    CHECK(kept["energy"][0] > free["energy"][0]);
}

TEST_CASE(
    "a painted mask of another size than the image is refused before anything runs, with both "
    "sizes",
    "[images]") {
    const Scratch scratch;
    const auto file = scratch.write(
        "p.yaml",
        "fluidcarve: 1\nextends: " SOURCE_ROOT
        "/pipelines/image.yaml\nnodes:\n"
        "  paint: {type: image.read, path: " TEST_DATA
        "/images/rocket.jpg, channels: {red: R}}\n"
        "  bright: {type: mask.threshold, field: paint.red, above: 0.75}\n"
        "  wide: {type: mask.dilate, mask: bright, voxels: 1}\n  seams: {protect: wide}\n");
    for (const std::string options : {"run -q ", "run -q --keep-going ", "plan "}) {
        const auto called = fluidcarve_program(
            options + file + " --to seams --set photo=" TEST_DATA "/images/chelsea.png");
        CHECK(called.code == 3);
        CHECK(called.out == "");
        CHECK(called.err ==
              "failed: seams (seam.pyramid): it lays pictures of two sizes over each other: "
              "'photo' reads 451 x 300 pixels, but 'paint' 640 x 427; scale one "
              "of them to the size of the other\n");
    }
}

TEST_CASE("a damaged image is an input that can't be read: exit code 3, its name, and no output",
          "[images]") {
    const Scratch scratch;
    const auto whole = Scratch::read(TEST_DATA "/images/rocket.jpg");
    for (const int frame : {1, 2, 3})
        scratch.write("in.000" + std::to_string(frame) + ".jpg", whole);
    scratch.write("in.0002.jpg", whole.substr(0, whole.size() / 2));
    const auto file =
        scratch.write("p.yaml", pipeline(scratch / "in.####.jpg", scratch / "out/o.####.png"));
    const auto ran = fluidcarve_program("run -q --threads 1 --in-flight 1 " + file);
    CHECK(ran.code == 3);
    CHECK_THAT(ran.err, Catch::Contains("failed: photo (image.read), frame 2: cannot read " +
                                        (scratch / "in.0002.jpg") + ": JPEG error: Premature end"));
    CHECK(fs::exists(scratch / "out/o.0001.png"));
    CHECK_FALSE(fs::exists(scratch / "out/o.0002.png"));

    // A PNG says how long it should be.
    const auto png = Scratch::read(TEST_DATA "/images/chelsea.png");
    for (const int frame : {1, 2, 3})
        scratch.write("in.000" + std::to_string(frame) + ".png",
                      frame == 2 ? png.substr(0, 100000) : png);
    const auto early =
        fluidcarve_program("run -q " + file + " --set photo.path=" + (scratch / "in.####.png") +
                           " --set out.path=" + (scratch / "none/o.####.png"));
    CHECK(early.code == 3);
    CHECK(early.err == "failed: photo (image.read), frame 2: cannot read " +
                           (scratch / "in.0002.png") +
                           ": it is cut off at byte 100000; copy or write it again\n");
    CHECK_FALSE(fs::exists(scratch / "none"));
}
