#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <filesystem>

namespace {

/// A plume's seams, found in one file, and a mesh carved by them. The file holds the mesh and
/// nothing else.
std::string pipeline(const std::string& frames, const std::string& count, const std::string& mesh,
                     const std::string& out, const std::string& more = {}) {
    return "fluidcarve: 1\nprovenance: false\n" + frames +
           "nodes:\n  sim: {type: vdb.read, path: " TEST_DATA
           "/plume/plume.0051.vdb, grids: {density: float}}\n"
           "  energy: {type: energy.gradient, field: sim.density}\n  box: {type: lattice.box, fit: "
           "sim.density}\n"
           "  seams: {type: seam.greedy, energy: energy, lattice: box, count: " +
           count + "}\n  mesh: {type: mesh.read, path: " + mesh +
           "}\n  carved: {type: remap.mesh, source: mesh, lattice: box, seams: seams" + more +
           "}\n  out: {type: mesh.write, source: carved, path: \"" + out + "\"}\n";
}

const std::string triangle =
    "o far\nv -5 0 0\nv -5 1 0\nv -5 0 1.25\nvt 0.5 0.5\nusemtl skin\nf 1/1 2/1 3/1\n";

Called run(const Scratch& scratch, const std::string& text) {
    return fluidcarve_program("run --progress none -q " + scratch.write("p.yaml", text));
}

}  // namespace

TEST_CASE("a mesh is carved by the seams of a volume, of one frame with or without a frame token") {
    const Scratch scratch;
    scratch.write("in.obj", triangle);
    for (const std::string out : {"out.obj", "out.##.obj"}) {
        const auto ran = run(scratch, pipeline("", "-3", "in.obj", scratch / out));
        CHECK(ran.err == "");
        CHECK(ran.code == 0);
    }
    CHECK(Scratch::read(scratch / "out.obj") == triangle);
    CHECK(Scratch::read(scratch / "out.01.obj") == triangle);
}

TEST_CASE("in a sequence a carved mesh comes per frame, or once where that is said") {
    const Scratch scratch;
    scratch.write("in.obj", triangle);
    CHECK(run(scratch, pipeline("frames: 1-2\n", "-3", "in.obj", scratch / "out.##.obj")).code ==
          0);
    CHECK(Scratch::read(scratch / "out.02.obj") == triangle);
    const auto refused =
        run(scratch, pipeline("frames: 1-2\n", "-3", "in.obj", scratch / "out.obj"));
    CHECK(refused.code == 2);
    CHECK(
        refused.err.find(
            "mesh.write writes a file for every frame: 'path' needs a frame token such as ####") !=
        std::string::npos);
    CHECK(run(scratch,
              pipeline("frames: 1-2\n", "-3", "in.obj", scratch / "one.obj", ", static: true"))
              .code == 0);
    CHECK(Scratch::read(scratch / "one.obj") == triangle);
}

TEST_CASE(
    "a mesh that can't be read ends a run by the code for unreadable inputs, and leaves no "
    "output") {
    const Scratch scratch;
    const auto told = [&](const std::string& name, const std::string& text) {
        scratch.write(name, text);
        const auto ran = run(scratch, pipeline("", "-1", name, scratch / "out.obj"));
        CHECK(ran.code == 3);
        CHECK(!std::filesystem::exists(scratch / "out.obj"));
        return ran.err;
    };
    const auto is = [&](const std::string& name, const std::string& message) {
        return Catch::Contains("mesh (mesh.read): " + (scratch / name) + message);
    };
    CHECK_THAT(told("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \xff\n"),
               is("a.obj", ":4: '?' is no whole number"));
    CHECK_THAT(
        told("a.ply", "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nend_header\n1\n"),
        is("a.ply", ": the header promises 9 entries"));
    CHECK_THAT(told("a.off", "OFF\n9 9 0\n"),
               is("a.off", ": the head promises 9 vertices and 9 faces"));
    CHECK_THAT(told("a.stl", "solid\nfacet normal 0 0 1\n"),
               is("a.stl", ":2: the file ends too early"));
    CHECK_THAT(run(scratch, pipeline("", "-1", "none.obj", scratch / "out.obj")).err,
               Catch::Contains("none.obj does not exist"));
}
