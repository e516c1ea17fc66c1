#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace {

/// Seams through two frames of the plume. @param lattice  fields of lattice.box
std::string pipeline(const Scratch& scratch, const std::string& lattice, const std::string& seams) {
    return scratch.write(
        "p.yaml",
        "fluidcarve: 1\nframes: 51-52\nnodes:\n"
        "  sim:    {type: vdb.read, path: " TEST_DATA
        "/plume/plume.####.vdb, grids: {density: float}}\n"
        "  energy: {type: energy.gradient, field: sim.density}\n"
        "  box:    {type: lattice.box, " +
            lattice +
            "}\n"
            "  seams:  {type: seam.greedy, energy: energy, lattice: box, axis: u, count: -3, " +
            seams +
            "}\n"
            "  kept:   {type: seams.write, seams: seams, path: " +
            (scratch / "seams.vdb") + "}\n");
}

nlohmann::json solved(const Scratch& scratch, const std::string& file, const std::string& solver) {
    const auto ran = fluidcarve_program("run -q " + file + " --set seams.type=" + solver +
                                        " --report " + (scratch / "report.json"));
    INFO(solver << ": " << ran.err);
    REQUIRE(ran.code == 0);
    return nlohmann::json::parse(Scratch::read(scratch / "report.json"))["seams"]["seams"];
}

}  // namespace

TEST_CASE(
    "a pipeline's solver is swapped by its type, and each seam is reported with a bound and a "
    "gap") {
    const Scratch scratch;
    const auto file = pipeline(scratch, "fit: sim.density", "window: [12, 29]");
    const auto exact = solved(scratch, file, "seam.graph_cut");
    const double least = exact["energy"][0];
    CHECK(exact["gap"][0].get<double>() < 1e-4);
    for (const auto* const solver : {"seam.greedy", "seam.pyramid", "seam.graph_cut"}) {
        const auto report = solved(scratch, file, solver);
        INFO(solver);
        REQUIRE(report["energy"].size() == 3);
        REQUIRE(report["lower_bound"].size() == 3);
        REQUIRE(report["gap"].size() == 3);
        for (std::size_t n = 0; n < 3; ++n) {
            const double energy = report["energy"][n], bound = report["lower_bound"][n],
                         gap = report["gap"][n];
            CHECK(bound > 0);
            CHECK(bound <= energy * (1 + 1e-6));
            CHECK(gap == Approx(std::max(energy / bound - 1, 0.0)).margin(1e-9));
        }
        CHECK(report["energy"][0].get<double>() >= least * (1 - 1e-6));
        CHECK(report["lower_bound"][0].get<double>() <= least * (1 + 1e-6));
    }
    const auto refused = fluidcarve_program("run -q " + file + " --set seams.type=seam.dynamic");
    CHECK(refused.code == 1);
    CHECK_THAT(refused.err, Catch::Contains("seam.dynamic needs columns in one line") &&
                                Catch::Contains("seam.pyramid"));
}

TEST_CASE("passes raise the reported bound") {
    const Scratch scratch;
    const auto reported = [&](const std::string& passes) {
        return solved(
            scratch,
            pipeline(scratch, "fit: sim.density", "window: [12, 29], bound_passes: " + passes),
            "seam.greedy");
    };
    const auto before = reported("0"), after = reported("10");
    CHECK(after["energy"] == before["energy"]);
    for (std::size_t n = 0; n < 3; ++n)
        CHECK(after["lower_bound"][n].get<double>() > before["lower_bound"][n].get<double>());
}

TEST_CASE(
    "where a lattice is one vertex thick and seams are static, dynamic programming finds what the "
    "cut and the pyramid find") {
    const Scratch scratch;
    // Voxels 5 to 38 along x and 4 to 70 along z, in the middle of y.
    const auto file = pipeline(scratch,
                               "min: [0.2272725, 0.9545445, 0.181818], max: [1.727271, 0.9545445, "
                               "3.181815], spacing: 0.0454545",
                               "static: true");
    const double least = solved(scratch, file, "seam.graph_cut")["energy"][0];
    CHECK(least > 0);
    for (const auto* const solver : {"seam.dynamic", "seam.pyramid"}) {
        const auto report = solved(scratch, file, solver);
        INFO(solver);
        CHECK(report["energy"][0].get<double>() == Approx(least).epsilon(1e-6));
        CHECK(report["lower_bound"][0].get<double>() == Approx(least).epsilon(1e-6));
    }
    CHECK(solved(scratch, file, "seam.greedy")["energy"][0].get<double>() >= least * (1 - 1e-6));
}
