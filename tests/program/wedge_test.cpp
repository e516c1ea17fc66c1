#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace fs = std::filesystem;

namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t out = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size())
        ++out;
    return out;
}

}  // namespace

TEST_CASE(
    "a wedge runs all combinations into folders of their own, and shows them on one sheet and one "
    "page",
    "[nightly][long]") {
    const Scratch scratch;
    const auto out = scratch / "w";
    const auto ran = fluidcarve_program(
        "wedge pipelines/plume.yaml --set frames=51-52 --over count=-2,-6 --over "
        "seams.type=seam.greedy,seam.pyramid -o " +
        out);
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK_THAT(
        ran.out,
        Catch::StartsWith(
            "count  seams.type    result\n-2     seam.greedy   seams: 2 seams removed, energy "));
    CHECK(count_of(ran.out, "carved.density: x -") == 4);
    for (const auto* const folder :
         {"01_count=-2_seams.type=seam.greedy", "02_count=-2_seams.type=seam.pyramid",
          "03_count=-6_seams.type=seam.greedy", "04_count=-6_seams.type=seam.pyramid"})
        for (const auto* const file : {"plume.0051.vdb", "plume.0052.vdb", "plume_seams.vdb",
                                       "plume.png", "report.json", "report.html"})
            CHECK(fs::exists(out + "/" + folder + "/" + file));
    CHECK_FALSE(fs::exists(scratch / "out"));
    // The largest count is solved first, and the other one is a part of it.
    CHECK(ran.err.find("1 of 4: count=-6, seams.type=seam.greedy") <
          ran.err.find("3 of 4: count=-2, seams.type=seam.greedy"));
    const auto report = nlohmann::json::parse(
        Scratch::read(out + "/02_count=-2_seams.type=seam.pyramid/report.json"));
    CHECK(report["nodes"]["seams"]["cached"] == report["nodes"]["seams"]["frames"]);
    CHECK(report["seams"]["seams"]["energy"].size() == 2);

    const auto sheet = nlohmann::json::parse(
        fluidcarve_program("inspect --json " + out + "/wedge.png").out)["files"][0];
    CHECK(sheet["width"].get<int>() > 2 * 600);
    const auto page = Scratch::read(out + "/wedge.html");
    CHECK(count_of(page, "src=\"data:image/png;base64,") == 4);
    CHECK_THAT(page, Catch::Contains("count = -2, seams.type = seam.pyramid") &&
                         Catch::Contains("<a href=\"view.html\">") && !Catch::Contains("<script"));
    const auto view = Scratch::read(out + "/view.html");
    CHECK(count_of(view, "\"differs\":[[\"count\",\"-") == 4);
    CHECK(count_of(view, "[\"seams.type\",\"seam.greedy\"]") == 2);
    CHECK(view.size() < 2 << 20);
}

TEST_CASE("a pipeline without a preview gets one in a wedge") {
    const Scratch scratch;
    const auto pipeline =
        scratch.write("p.yaml",
                      "fluidcarve: 1\nframes: 51\nnodes:\n"
                      "  sim: {type: vdb.read, path: " SOURCE_ROOT
                      "/tests/data/plume/plume.####.vdb, grids: {density: float}}\n"
                      "  energy: {type: energy.gradient, field: sim.density}\n"
                      "  box: {type: lattice.box, fit: sim.density}\n"
                      "  seams: {type: seam.greedy, energy: energy, lattice: box, count: -2}\n"
                      "  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}\n"
                      "  out: {type: vdb.write, source: carved, path: out/o.####.vdb}\n");
    const auto ran =
        fluidcarve_program("wedge " + pipeline + " --over seams.count=-1,-3 -o " + (scratch / "w"));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK(fs::exists(scratch / "w/01_seams.count=-1/wedge_sheet.png"));
    CHECK(fs::exists(scratch / "w/02_seams.count=-3/o.0051.vdb"));
    CHECK(fs::exists(scratch / "w/view.html"));
}

TEST_CASE("a wedge tells wrong values before the first run") {
    const Scratch scratch;
    const auto wrong = [&](const std::string& arguments) {
        const auto ran = fluidcarve_program("wedge pipelines/plume.yaml -o " + (scratch / "w") +
                                            " " + arguments);
        CHECK(ran.code == 2);
        CHECK_FALSE(fs::exists(scratch / "w"));
        return ran.err;
    };
    CHECK_THAT(wrong("--over cuont=-2,-4"),
               Catch::StartsWith(
                   "--over:1:1: there is no param 'cuont'; did you mean 'count'?\ncuont=-2\n"));
    CHECK_THAT(wrong("--over count=-2,much"),
               Catch::Contains("--over:1:7: ") && Catch::Contains("not 'much'"));
    CHECK_THAT(wrong("--over count="), Catch::Contains("is empty"));
    CHECK_THAT(wrong("--over count=-2 --report r.json"), Catch::Contains("a wedge has many runs"));
}
