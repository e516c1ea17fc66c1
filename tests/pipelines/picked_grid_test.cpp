#include "formats/vdb/vdb_file.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/program.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

/// Carves two frames of the plume and goes on with a grid of the result.
/// @param more  the nodes that follow
std::string pipeline(const Scratch& scratch, const std::string& more) {
    return scratch.write(
        "p.yaml",
        "fluidcarve: 1\nframes: 51-52\nnodes:\n"
        "  sim:    {type: vdb.read, path: " TEST_DATA
        "/plume/plume.####.vdb, grids: {density: float}}\n"
        "  energy: {type: energy.gradient, field: sim.density}\n"
        "  box:    {type: lattice.box, fit: sim.density}\n"
        "  seams:  {type: seam.greedy, energy: energy, lattice: box, count: -2}\n"
        "  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}\n"
        "  smooth: {type: filter.seam, source: carved, lattice: box, seams: seams}\n" +
            more);
}

}  // namespace

TEST_CASE("grids of a carved volume are taken by their names, as those of a reader are") {
    const Scratch scratch;
    const auto file = pipeline(scratch,
                               "  slope: {type: energy.gradient, field: smooth.density}\n"
                               "  a: {type: vdb.write, source: smooth, path: \"" +
                                   (scratch / "all.####.vdb") +
                                   "\"}\n"
                                   "  b: {type: vdb.write, source: smooth.density, path: \"" +
                                   (scratch / "one.####.vdb") +
                                   "\"}\n"
                                   "  c: {type: vdb.write, source: slope, path: \"" +
                                   (scratch / "slope.####.vdb") + "\"}\n");
    CHECK(fluidcarve_program("check " + file).err == "");
    CHECK_THAT(fluidcarve_program("graph --format dot " + file).out,
               Catch::Contains("smooth.density (float) -> slope.field"));
    const auto ran = fluidcarve_program("run -q " + file);
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    for (const auto* const frame : {"0051", "0052"}) {
        const auto read = [&](const std::string& name) {
            return read_vdb(scratch / (name + "." + frame + ".vdb"));
        };
        const auto one = read("one");
        CHECK(one.names() == "density");
        CHECK(
            test::bytes(openvdb::gridConstPtrCast<FloatGrid>(one.find("density"))->tree()) ==
            test::bytes(openvdb::gridConstPtrCast<FloatGrid>(read("all").find("density"))->tree()));
        CHECK(read("slope").grids.size() == 1);
    }
}

TEST_CASE(
    "a grid that a carved volume does not have is told before the first frame, with those that it "
    "has") {
    const Scratch scratch;
    const auto told = [&](const std::string& name) {
        const auto file =
            pipeline(scratch, "  slope: {type: energy.gradient, field: smooth." + name + "}\n");
        CHECK(fluidcarve_program("check " + file).code == 0);
        const auto ran =
            fluidcarve_program("run --progress none " + file + " --report " + (scratch / "r.json"));
        CHECK(ran.code == 3);
        CHECK_THAT(Scratch::read(scratch / "r.json"), Catch::Contains("\"nodes\": {}"));
        return ran.err;
    };
    const std::string plume = TEST_DATA "/plume/plume.0051.vdb";
    CHECK_THAT(told("densty"),
               Catch::StartsWith("failed: sim (vdb.read), frame 51: " + plume +
                                 " has no grid 'densty', but 'slope' takes smooth.densty; it has "
                                 "velocity, density, shadow, temperature, "
                                 "flame; did you mean 'density'?\n"));
    CHECK_THAT(
        told("velocity"),
        Catch::StartsWith(
            "failed: sim (vdb.read), frame 51: " + plume +
            " has the grid 'velocity' as vec3s, but 'slope' takes smooth.velocity as float\n"));
}

TEST_CASE("where no header tells, the first frame does, and only volumes have grids") {
    const Scratch scratch;
    const auto lone = scratch.write(
        "lone.yaml",
        "fluidcarve: 1\nframes: 51-51\nnodes:\n"
        "  sim:    {type: vdb.read, path: " TEST_DATA
        "/plume/plume.####.vdb, grids: {density: float}}\n"
        "  energy: {type: energy.gradient, field: sim.density}\n"
        "  box:    {type: lattice.box, fit: sim.density}\n"
        "  seams:  {type: seam.greedy, energy: energy, lattice: box, count: -2}\n"
        "  carved: {type: remap.grids, source: sim.density, lattice: box, seams: seams}\n"
        "  slope:  {type: energy.gradient, field: carved.heat}\n");
    const auto ran = fluidcarve_program("run -q " + lone);
    CHECK(ran.code == 1);
    CHECK(ran.err ==
          "failed: slope (energy.gradient), frame 51: input 'field': 'carved' has no grid 'heat'; "
          "it has density\n");
    const auto check = fluidcarve_program(
        "check " + pipeline(scratch, "  slope: {type: energy.gradient, field: energy.density}\n"));
    CHECK(check.code == 2);
    CHECK_THAT(check.err, Catch::Contains(
                              "'energy' (energy.gradient) has no output 'density'; known: energy"));
}
