#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace {

/// A protected plume, carved in two frames.
struct Carve {
    Scratch scratch;
    std::string file = scratch.write(
        "p.yaml",
        "fluidcarve: 1\nframes: 51-52\nnodes:\n"
        "  sim:    {type: vdb.read, path: " TEST_DATA
        "/plume/plume.####.vdb, grids: {density: float}}\n"
        "  energy: {type: energy.gradient, field: sim.density}\n"
        "  box:    {type: lattice.box, fit: sim.density}\n"
        "  jet:    {type: mask.threshold, field: sim.density, above: 0.9}\n"
        "  seams:  {type: seam.greedy, energy: energy, lattice: box, protect: jet, count: -40}\n"
        "  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}\n"
        "  out:    {type: vdb.write, source: carved, path: \"" +
            (scratch / "out.####.vdb") + "\"}\n");
    nlohmann::json report, seams;  ///< the report, and what it says of the seams

    Called run(const std::string& settings) {
        auto out = fluidcarve_program("run --progress none --work " + (scratch / "work") + " " +
                                      file + " --report " + (scratch / "r.json") + " " + settings);
        report = nlohmann::json::parse(Scratch::read(scratch / "r.json"));
        seams = report["seams"].value("seams", nlohmann::json());
        return out;
    }
    bool kept(const std::string& node) const {
        return report["nodes"][node]["cached"] == report["nodes"][node]["frames"];
    }
};

const std::string way_closes =
    "window [0, 41]: in frame 51 of the 16 vertices left in column (0 to 41, 10, 22), from "
    "(0.0454545, 0.5, 1.04545) to (1.90909, 0.5, 1.04545), 11 are "
    "unprotected, but out of reach from the columns beside";

}  // namespace

TEST_CASE(
    "with best_effort a shot gets the seams that there is room for, and later runs know that there "
    "are no more") {
    Carve carve;
    const auto stopped = carve.run("");
    CHECK(stopped.code == 1);
    CHECK(stopped.err == "failed: seams (seam.greedy): 26 of 40 seams are possible in " +
                             way_closes +
                             "; ask for fewer, widen the window or protect less; `best_effort: "
                             "true` takes as many as there are (--set NODE.best_effort=true)\n");

    const auto first = carve.run("--set seams.best_effort=true");
    CHECK(first.code == 0);
    CHECK_THAT(
        first.err,
        Catch::Contains(
            "warning: seams (seam.greedy): finds 26 of 40 seams, as many as there is room for in " +
            way_closes + "\n"));
    CHECK(carve.seams["energy"].size() == 26);
    CHECK(carve.seams["asked"] == 40);
    CHECK(carve.seams["no_more"] == way_closes);
    const auto energy = carve.seams["energy"];

    // Another count, and nothing is searched.
    const auto more = carve.run("--set seams.best_effort=true --set seams.count=-41");
    CHECK(more.code == 0);
    CHECK(carve.kept("seams"));
    CHECK_THAT(
        more.err,
        Catch::Contains(
            "warning: seams (seam.greedy): finds 26 of 41 seams, as many as there is room for in " +
            way_closes + "\n"));
    CHECK(carve.seams["asked"] == 41);

    // What was made of too few is no answer to those who want all.
    CHECK(carve.run("").code == 1);
    const auto all = carve.run("--set seams.count=-26");
    CHECK(all.code == 0);
    CHECK_THAT(all.err, !Catch::Contains("warning: seams"));
    CHECK(carve.kept("seams"));
    CHECK(carve.seams["energy"] == energy);
    CHECK(!carve.seams.contains("asked"));
}

TEST_CASE("a count that would remove everything fails once, before the solve") {
    Carve carve;
    const auto run = carve.run("--set seams.count=-100%");
    CHECK(run.code == 1);
    CHECK(run.err ==
          "failed: seams (seam.greedy), frame 51: count -100% removes all 42 vertices along u; at "
          "most 41 can go\n");
}
