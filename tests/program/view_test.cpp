#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <filesystem>

namespace fs = std::filesystem;

namespace {

/// The plume, short, with all that it writes in a folder.
std::string short_plume(const Scratch& scratch) {
    return "pipelines/plume.yaml --set frames=51-52 --set count=-3 --set out=" +
           (scratch / "plume.####.vdb") + " --set seams=" + (scratch / "seams.vdb") +
           " --set sheet=" + (scratch / "sheet.png") + " --work " + (scratch / "work");
}

}  // namespace

TEST_CASE("view shows where seams are to be found, and the carve once there are seams") {
    const Scratch scratch;
    const auto page = scratch / "out/view.html";
    const auto view = [&](const std::string& options) {
        const auto ran =
            fluidcarve_program("view " + short_plume(scratch) + " -o " + page + options);
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        CHECK(ran.out == page + "\n");
        return std::pair(Scratch::read(page), ran.err);
    };
    const auto [before, told] = view("");
    CHECK_THAT(before, Catch::Contains("\"sets\":[]") && Catch::Contains("\"energyRange\":[0,"));
    CHECK_THAT(told, Catch::Contains(
                         "the seams are not found yet: the page shows where; --solve finds them"));
    CHECK_FALSE(fs::exists(scratch / "seams.vdb"));
    const auto [after, silent] = view(" --solve -q");
    CHECK(silent == "");
    CHECK_THAT(after, Catch::Contains("\"setting\":\"count\",\"count\":3,") &&
                          Catch::Contains("\"kind\":\"remove\""));
    // What an earlier run found is shown without a word.
    CHECK(view(" -q").first == after);
    CHECK_FALSE(fs::exists(scratch / "plume.0051.vdb"));
}

TEST_CASE("the pages of shipped pipelines stay below 2 MB", "[long]") {
    const Scratch scratch;
    for (const std::string name : {"plume", "vortex", "river", "image"}) {
        INFO(name);
        const auto page = scratch / (name + ".html");
        REQUIRE(fluidcarve_program("view pipelines/" + name + ".yaml --solve -q -o " + page).code ==
                0);
        CHECK(fs::file_size(page) < 2 << 20);
        CHECK_THAT(Scratch::read(page), !Catch::Contains("\"sets\":[]"));
    }
}

TEST_CASE("view plays what a change of time makes, or else what is written") {
    const Scratch scratch;
    const auto frames_of = [&](const std::string& arguments) {
        const auto page = scratch / "view.html";
        const auto ran = fluidcarve_program("view " + arguments + " -o " + page + " --work " +
                                            (scratch / "work"));
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        const auto text = Scratch::read(page);
        CHECK_THAT(text, Catch::Contains("\"sets\":[]"));
        std::string out;
        for (int frame = 51; frame < 62; ++frame)
            if (text.find("\"number\":" + std::to_string(frame) + ",") != std::string::npos)
                out += " " + std::to_string(frame);
        return out;
    };
    CHECK(frames_of("pipelines/plume_shorter.yaml") == " 51 52 53 54");
    CHECK(frames_of("pipelines/plume_slow.yaml") == " 51 52 53 54 55 56 57 58 59 60 61");
    const auto written =
        scratch.write("p.yaml",
                      "fluidcarve: 1\nframes: 51-52\nnodes:\n"
                      "  sim: {type: vdb.read, path: " SOURCE_ROOT
                      "/tests/data/plume/plume.####.vdb, grids: {density: float}}\n"
                      "  out: {type: vdb.write, source: sim, path: out/o.####.vdb}\n");
    CHECK(frames_of(written) == " 51 52");
}

TEST_CASE("view says what a pipeline lacks to be shown") {
    const Scratch scratch;
    const auto pipeline =
        scratch.write("p.yaml",
                      "fluidcarve: 1\nframes: 51\nnodes:\n"
                      "  sim: {type: vdb.read, path: " SOURCE_ROOT
                      "/tests/data/plume/plume.####.vdb, grids: {density: float}}\n"
                      "  energy: {type: energy.gradient, field: sim.density}\n");
    const auto ran = fluidcarve_program("view " + pipeline);
    CHECK(ran.code == 2);
    CHECK_THAT(ran.err, Catch::Contains("nothing says what to show; add a preview.page"));
}

TEST_CASE("the report page links to the page of a preview.page") {
    const Scratch scratch;
    const auto pipeline =
        scratch.write("p.yaml",
                      "fluidcarve: 1\nframes: 51\nnodes:\n"
                      "  sim: {type: vdb.read, path: " SOURCE_ROOT
                      "/tests/data/plume/plume.####.vdb, grids: {density: float}}\n"
                      "  page: {type: preview.page, before: sim, path: \"" +
                          (scratch / "a folder/page.html") + "\"}\n");
    const auto ran =
        fluidcarve_program("run " + pipeline + " -q --html " + (scratch / "report.html"));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK(fs::exists(scratch / "a folder/page.html"));
    CHECK_THAT(Scratch::read(scratch / "report.html"),
               Catch::Contains("href=\"a%20folder/page.html\"") && !Catch::Contains("<script"));
}
