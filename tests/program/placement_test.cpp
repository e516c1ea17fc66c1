#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <regex>

namespace {

/// Settings that send all that vortex.yaml writes to a folder.
std::string vortex_into(const Scratch& scratch) {
    return " pipelines/vortex.yaml --set out=" + (scratch / "out.####.vdb") +
           " --set seams=" + (scratch / "seams.vdb") + " --set sheet=" + (scratch / "sheet.png");
}

const std::string beside =
    "warning: seams (seam.pyramid): the lattice misses the data: it lies within (-6.02591, "
    "-6.02591, -1.02591) to (6.02591, 6.02591, 1.02591), but the files "
    "that `energy` comes from have voxels, by their headers, only from (-1.69444, -1.69444, "
    "-0.722222) to (1.69444, 1.63889, 0.722222); move the lattice (its "
    "rig, or `min` and `max`) or the data (`translate` and `scale` of its reader)\n";

}  // namespace

TEST_CASE(
    "a lattice beside the data is told by plan, and by run before the first frame, and no seam is "
    "looked for in it") {
    const Scratch scratch;
    const auto planned = fluidcarve_program("plan" + vortex_into(scratch) + " --set rig.radius=5");
    CHECK(planned.err == beside);
    CHECK(planned.code == 0);
    const auto quiet = fluidcarve_program("plan -q" + vortex_into(scratch) + " --set rig.radius=5");
    CHECK(quiet.err == "");
    const auto ran =
        fluidcarve_program("run --progress none" + vortex_into(scratch) + " --set rig.radius=5");
    CHECK_THAT(ran.err, Catch::StartsWith(beside + "failed: seams (seam.pyramid): the lattice "
                                                   "misses the energy: its lattice of 28 x 26 x "));
    CHECK_THAT(ran.err, Catch::EndsWith("; move the lattice (its rig, or `min` and `max`) or the "
                                        "data (`translate` and `scale` of its reader)\n"));
    CHECK(std::regex_search(ran.err,
                            std::regex("along a circle of radius 5 around \\(0, 0, 0\\), u from "
                                       "-0\\.75, v from -0\\.7, spacing 0\\.0555556, but")));
    CHECK(ran.code == 1);
    CHECK(fluidcarve_program("plan" + vortex_into(scratch)).err == "");
}

TEST_CASE("a lattice around little of the content is told once, at once") {
    const Scratch scratch;
    const auto pipeline =
        scratch.write("part.yaml", R"(fluidcarve: 1
frames: 51-52
nodes:
  sim:    {type: vdb.read, path: )" SOURCE_ROOT
                                   R"(/tests/data/plume/plume.####.vdb, grids: {density: float}}
  energy: {type: energy.gradient, field: sim.density}
  box:    {type: lattice.box, min: [0.9090909, 0.9090909, 1.8181818], max: [1.1363636, 1.1363636, 2.0454545], spacing: 0.0454545454}
  seams:  {type: seam.pyramid, energy: energy, lattice: box, count: -1}
  kept:   {type: seams.write, seams: seams, path: )" +
                                       (scratch / "seams.vdb") + "}\n");
    const auto ran = fluidcarve_program("run --progress none " + pipeline);
    CHECK(std::regex_search(ran.err,
                            std::regex("^warning: seams \\(seam\\.pyramid\\): 0\\.\\d+ % of the "
                                       "active voxels of `energy` lie in the lattice, and "
                                       "nothing else will change: if that is not meant, move the "
                                       "lattice \\(its rig, or `min` and `max`\\) or make "
                                       "it larger\n(warning: .*\n)*done: 2 frames in .*\n$")));
    CHECK(ran.err.find("active voxels") == ran.err.rfind("active voxels"));
    CHECK(ran.code == 0);
}

TEST_CASE("a lattice too fine for the memory says which spacing fits") {
    const Scratch scratch;
    const auto ran = fluidcarve_program("run --progress none" + vortex_into(scratch) +
                                        " --set ring.spacing=0.002 --memory 64M");
    CHECK_THAT(ran.err, Catch::Contains("failed: seams (seam.pyramid), frame 41: at a 'spacing' of "
                                        "0.002 the lattice has 751 x 701 x "));
    CHECK_THAT(ran.err,
               Catch::Contains(
                   "; the voxels of `energy` are 0.0555556 wide: a 'spacing' of 0.0555556 fits\n"));
    CHECK(ran.code == 1);
}

TEST_CASE("check tells at the node, without a look at files, what its lattice has no room for") {
    const Scratch scratch;
    const auto pipeline = scratch.write("narrow.yaml", R"(fluidcarve: 1
nodes:
  sim:    {type: vdb.read, path: gone.vdb, grids: {density: float}}
  energy: {type: energy.gradient, field: sim.density}
  box:    {type: lattice.box, min: [0, 0, 0], max: [9, 9, 9], spacing: 1}
  warp:   {type: warp.solve, energy: energy, lattice: box, amount: -9.5}
  seams:  {type: seam.pyramid, energy: energy, lattice: box, count: -3, window: [4, 10]}
  kept:   {type: seams.write, seams: warp, path: warp.vdb}
  other:  {type: seams.write, seams: seams, path: seams.vdb}
  carved: {type: remap.grids, source: sim, lattice: box, seams: warp}
  smooth: {type: filter.seam, source: carved, lattice: box, seams: warp}
  out:    {type: vdb.write, source: smooth, path: out.vdb}
)");
    const auto checked = fluidcarve_program("check " + pipeline);
    CHECK(checked.code == 2);
    CHECK_THAT(checked.err,
               Catch::Contains("narrow.yaml:6:3: warp.solve the amount squeezes window [0, 9] by "
                               "9.5 vertices, but at most 8.1 are possible") &&
                   Catch::Contains("narrow.yaml:7:3: seam.pyramid window [4, 10] leaves the "
                                   "lattice, which has 10 vertices along u: 0 to 9\n") &&
                   Catch::Contains("narrow.yaml:11:3: filter.seam a warp is among the `seams`"));
}
