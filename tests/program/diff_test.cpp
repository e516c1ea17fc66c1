#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace fs = std::filesystem;

namespace {

/// Two sequences of a line: frame 1 is the same, in frame 2 point 1 is half a unit off.
void write_lines(const Scratch& scratch) {
    for (const auto* const name : {"a.0001.csv", "a.0002.csv", "b.0001.csv"})
        scratch.write(name, "x,y,z\n0,0,0\n1,0,0\n");
    scratch.write("b.0002.csv", "x,y,z\n0,0,0\n1,0,0.5\n");
}

std::string both(const Scratch& scratch) {
    return "diff " + (scratch / "a.####.csv") + " " + (scratch / "b.####.csv");
}

}  // namespace

TEST_CASE("diff says what differs, where and by how much, and ends with 1") {
    const Scratch scratch;
    write_lines(scratch);
    const auto ran = fluidcarve_program(both(scratch));
    CHECK(ran.code == 1);
    CHECK(ran.err == "");
    const auto head =
        (scratch / "a.####.csv") + " and " + (scratch / "b.####.csv") + ", frames 1,2\n";
    const std::string place =
        "    mean 0.125, RMS 0.25, peak 0.5: frame 2, point 1, world [1, 0, 0]: [1, 0, 0] in A, "
        "[1, 0, 0.5] in B\n";
    CHECK(ran.out == head + "  curve: different in frame 2\n    1 of 4 points differ\n" + place);
    CHECK(fluidcarve_program(both(scratch) + " --threads 1").out == ran.out);

    const auto within = fluidcarve_program(both(scratch) + " --fail 0.6 --warn 0.4");
    CHECK(within.code == 0);
    CHECK(within.out == head +
                            "  curve: the same within the thresholds, with warnings\n    0 of 4 "
                            "points differ by more than 0.6, 1 by more than 0.4\n" +
                            place);
    CHECK(fluidcarve_program(both(scratch) + " --fail-percent 50").code == 0);
    CHECK(fluidcarve_program(both(scratch) + " --fail-percent 49").code == 1);
    CHECK(fluidcarve_program(both(scratch) + " --relative 0.45").code == 0);
    const auto first = fluidcarve_program(both(scratch) + " -f 1");
    CHECK(first.code == 0);
    CHECK(first.out == (scratch / "a.####.csv") + " and " + (scratch / "b.####.csv") +
                           ", frame 1\n  curve: the same\n");
}

TEST_CASE("diff --json says the same for programs") {
    const Scratch scratch;
    write_lines(scratch);
    const auto ran = fluidcarve_program(both(scratch) + " --json");
    CHECK(ran.code == 1);
    const auto json = nlohmann::json::parse(ran.out);
    CHECK(json["result"] == "different");
    CHECK(json["failures"].empty());
    CHECK(json["alone"].empty());
    const auto& pair = json["sequences"].at(0);
    CHECK(pair["frames"] == "1,2");
    const auto& part = pair["parts"].at(0);
    CHECK(part["name"] == "curve");
    CHECK(part["different_frames"] == "2");
    CHECK(part["compared"] == 4);
    CHECK(part["over"] == 1);
    CHECK(part["mean"] == 0.125);
    CHECK(part["rms"] == 0.25);
    CHECK(part["peak"] == 0.5);
    CHECK(part["worst"]["frame"] == 2);
    CHECK(part["worst"]["index"] == nlohmann::json::array({1}));
    CHECK(part["worst"]["b"] == nlohmann::json::array({1.0, 0.0, 0.5}));
}

TEST_CASE(
    "frames and files that one side lacks are differences, and those asked for and missing end "
    "with 3") {
    const Scratch scratch;
    write_lines(scratch);
    fs::remove(scratch / "b.0001.csv");
    fs::copy_file(scratch / "a.0002.csv", scratch / "b.0002.csv",
                  fs::copy_options::overwrite_existing);
    const auto ran = fluidcarve_program(both(scratch));
    CHECK(ran.code == 1);
    CHECK(ran.out == (scratch / "a.####.csv") + " and " + (scratch / "b.####.csv") +
                         ", frame 2\n  only in A: frame 1\n  curve: the same\n");
    const auto missing = fluidcarve_program(both(scratch) + " -f 1");
    CHECK(missing.code == 3);
    CHECK(missing.err == "failed: " + (scratch / "b.0001.csv") + " does not exist\n");

    fs::create_directories(scratch / "c");
    fs::create_directories(scratch / "d");
    for (const auto* const name : {"c/x.csv", "d/x.csv", "c/y.csv"})
        fs::copy_file(scratch / "a.0001.csv", scratch / name);
    const auto folders = fluidcarve_program("diff " + (scratch / "c") + " " + (scratch / "d"));
    CHECK(folders.code == 1);
    CHECK(folders.out == (scratch / "c/x.csv") + " and " + (scratch / "d/x.csv") +
                             "\n  curve: the same\nonly in A: " + (scratch / "c/y.csv") + "\n");
}

TEST_CASE("what diff can't compare is told before anything is read") {
    const Scratch scratch;
    write_lines(scratch);
    const auto a = scratch / "a.0001.csv";
    const auto refused = [](const std::string& arguments) {
        const auto ran = fluidcarve_program("diff " + arguments);
        CHECK(ran.code == 2);
        CHECK(ran.out == "");
        return ran.err;
    };
    CHECK(refused("README.md README.md") ==
          "diff compares files that end in .vdb, .png, .exr, .jpg, .jpeg, .tif, .tiff, .obj, .ply, "
          ".off, .stl, .csv, and folders of them, not README.md\n");
    CHECK(refused(a + " tests/data/images/chelsea.png") ==
          a + " and tests/data/images/chelsea.png are files of different kinds\n");
    CHECK(refused((scratch / "a.####.csv") + " " + a) ==
          (scratch / "a.####.csv") + " is a sequence, but " + a +
              " is one file; name two sequences or two files\n");
    CHECK(refused("tests/data " + a) ==
          "tests/data is a folder, but " + a +
              " is not; name two folders, two sequences or two files\n");
    CHECK(refused(a + " " + a + " --warn 0.1") ==
          "--warn 0.1 is above --fail 0: what it would warn of fails; give --fail a greater "
          "number\n");
    CHECK(refused(a + " " + a + " --picture p.jpg") ==
          "--picture writes PNG: name a file that ends in .png, not p.jpg\n");
    CHECK(refused(a + " " + a + " -f 1") ==
          "-f is for sequences; " + a + " has no frame token such as ####\n");
    const auto none = fluidcarve_program("diff " + (scratch / "z.####.csv") + " " + a);
    CHECK(none.code == 3);
    CHECK(none.err == "failed: " + (scratch / "z.####.csv") + ": there is no file of any frame\n");
}

TEST_CASE("volumes and images are compared and drawn") {
    const Scratch scratch;
    const std::string sphere = "tests/data/vdb/oiio_sphere.vdb",
                      image = "tests/data/images/chelsea.png";
    const auto same = fluidcarve_program("diff " + sphere + " " + sphere + " --picture " +
                                         (scratch / "same.png"));
    CHECK(same.code == 0);
    CHECK(same.out == sphere + " and " + sphere + "\n  density: the same\n");
    CHECK(same.err ==
          (scratch / "same.png") + " is not written: no values of grids or images differ\n");
    CHECK(fluidcarve_program("diff " + image + " " + image).out ==
          image + " and " + image + "\n  R: the same\n  G: the same\n  B: the same\n");

    const auto fire = fluidcarve_program(
        "diff tests/data/bonfire/bonfire.0037.vdb tests/data/bonfire/bonfire.0038.vdb --picture " +
        (scratch / "fire.png"));
    CHECK(fire.code == 1);
    CHECK(fire.err == "");
    CHECK_THAT(fire.out, Catch::Contains("  flame: different\n") &&
                             Catch::Contains("  shadow: the same\n") &&
                             Catch::Contains("are active in B only"));
    CHECK(Scratch::read(scratch / "fire.png").starts_with("\x89PNG"));
}
