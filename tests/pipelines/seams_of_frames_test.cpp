#include "tests/support/files/vdb_sequences.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

// `axis: t`, run by the program on a puff of smoke with a mask and points beside it.

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

/// Writes frames 1 to `last` of a puff that circles, and rests from frame 8 to 13.
void write_resting(const Scratch& scratch, int last) {
    for (int frame = 1; frame <= last; ++frame) {
        const double turn = 2 * M_PI / 40 * (frame <= 8 ? frame : frame <= 13 ? 8 : frame - 5);
        const auto puff = puff_around(8.0 * Vec3d(std::cos(turn), std::sin(turn), 0));
        const auto count = openvdb::Int32Grid::create();
        count->setName("count");
        count->tree().topologyUnion(puff->tree());
        for (auto voxel = count->beginValueOn(); voxel; ++voxel) voxel.setValue(frame);
        openvdb::io::File(file_at(scratch / "puff", frame)).write({puff, count});
    }
}

/// A pipeline that carves frames.
/// @param seams  further fields of the solver
std::string pipeline(const Scratch& scratch, const std::string& name, const std::string& frames,
                     const std::string& seams, const std::string& remap = "",
                     const std::string& more = "") {
    return scratch.write(
        name + ".yaml",
        fmt::format("fluidcarve: 1\nframes: {}\nnodes:\n"
                    "  sim: {{type: vdb.read, path: {}, grids: {{density: float}}}}\n"
                    "  edges: {{type: energy.gradient, field: sim.density}}\n"
                    "  box: {{type: lattice.box, fit: sim.density}}\n"
                    "  seams: {{type: seam.pyramid, energy: edges, field: sim.density, lattice: "
                    "box, axis: t, {}}}\n"
                    "  carved: {{type: remap.grids, source: sim, lattice: box, seams: seams{}}}\n"
                    "  out: {{type: vdb.write, source: carved, path: {}}}\n{}",
                    frames, scratch / "puff.####.vdb", seams, remap, scratch / name + ".####.vdb",
                    more));
}

Called run(const Scratch& scratch, const std::string& file, const std::string& options = "") {
    return fluidcarve_program(
        fmt::format("run {} --progress none --work {} {}", file, scratch / "work", options));
}

}  // namespace

TEST_CASE("a pause is what leaves a sequence, and all other frames keep their bits") {
    const Scratch scratch;
    write_resting(scratch, 21);
    const auto ran = run(scratch, pipeline(scratch, "shorter", "1-21", "count: -4", ", join: cut"));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK_FALSE(std::filesystem::exists(file_at(scratch / "shorter", 18)));
    for (int n = 1; n <= 17; ++n) {
        const auto out = file_at(scratch / "shorter", n),
                   in = file_at(scratch / "puff", n <= 8 ? n : n + 4);
        CHECK_THAT(fluidcarve_program("diff " + out + " " + in).out,
                   Catch::Contains("density: the same"));
    }
}

TEST_CASE("a sequence becomes as much longer in time as its seams say, whole numbers unmixed") {
    const Scratch scratch;
    write_resting(scratch, 12);
    const auto ran = run(scratch, pipeline(scratch, "longer", "1-12", "count: 25%"));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK_FALSE(std::filesystem::exists(file_at(scratch / "longer", 16)));
    CHECK(difference_of(file_at(scratch / "longer", 1), file_at(scratch / "puff", 1)) == "");
    CHECK(difference_of(file_at(scratch / "longer", 15), file_at(scratch / "puff", 12)) == "");
    for (int n = 1; n <= 15; ++n) {
        openvdb::io::File file(file_at(scratch / "longer", n));
        file.open(false);
        const auto count = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("count"));
        for (auto value = count->cbeginValueOn(); value; ++value)
            REQUIRE((*value >= 1 && *value <= 12));
    }
}

TEST_CASE("seams of frames that were kept carve what fewer would, in parts as in one run") {
    const Scratch scratch;
    write_resting(scratch, 12);
    const auto kept =
        "  kept: {type: seams.write, seams: seams, path: " + (scratch / "seams.vdb") + "}\n";
    REQUIRE(run(scratch, pipeline(scratch, "all", "1-12", "count: -3", "", kept)).code == 0);
    REQUIRE(run(scratch, pipeline(scratch, "two", "1-12", "count: -2")).code == 0);
    const auto read = scratch.write(
        "read.yaml",
        fmt::format("fluidcarve: 1\nframes: 1-12\nnodes:\n"
                    "  sim: {{type: vdb.read, path: {}, grids: {{density: float}}}}\n"
                    "  box: {{type: lattice.box, fit: sim.density}}\n"
                    "  seams: {{type: seams.read, path: {}}}\n"
                    "  carved: {{type: remap.grids, source: sim, lattice: box, seams: seams, "
                    "count: -2}}\n"
                    "  out: {{type: vdb.write, source: carved, path: {}}}\n",
                    scratch / "puff.####.vdb", scratch / "seams.vdb", scratch / "read.####.vdb"));
    REQUIRE(run(scratch, read).code == 0);
    CHECK(difference_of(scratch / "two.####.vdb", scratch / "read.####.vdb") == "");
    for (const auto* const part : {"1-4", "5-10"}) {
        const auto ran = run(scratch, pipeline(scratch, "parts", "1-12", "count: -2"),
                             fmt::format("-f {} --no-cache --threads 1", part));
        INFO(ran.err);
        REQUIRE(ran.code == 0);
    }
    CHECK(difference_of(scratch / "two.####.vdb", scratch / "parts.####.vdb") == "");
}

TEST_CASE("particles and meshes beside a volume lose the frames that it loses") {
    const Scratch scratch;
    write_resting(scratch, 21);
    for (int frame = 1; frame <= 21; ++frame) {
        const double turn = 2 * M_PI / 40 * (frame <= 8 ? frame : frame <= 13 ? 8 : frame - 5);
        scratch.write(fmt::format("drops.{:04}.ply", frame),
                      fmt::format("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                  "property float y\nproperty float z\nproperty int id\n"
                                  "property int frame\nend_header\n{} {} 0 7 {}\n",
                                  8 * std::cos(turn), 8 * std::sin(turn), frame));
        scratch.write(fmt::format("bank.{:04}.obj", frame),
                      fmt::format("v {0} {1} 0\nv {0} {1} 1\nv {0} 0 1\nf 1 2 3\n",
                                  8 * std::cos(turn), 8 * std::sin(turn)));
    }
    const auto geometry = [&](const std::string& join) {
        return fmt::format(
            "  drops: {{type: points.read, path: {}}}\n"
            "  fewer: {{type: remap.points, source: drops, lattice: box, seams: seams{}}}\n"
            "  drops_out: {{type: points.write, source: fewer, path: {}}}\n"
            "  bank: {{type: mesh.read, path: {}}}\n"
            "  less: {{type: remap.mesh, source: bank, lattice: box, seams: seams{}}}\n"
            "  bank_out: {{type: mesh.write, source: less, path: {}}}\n",
            scratch / "drops.####.ply", join, scratch / "out.####.ply", scratch / "bank.####.obj",
            join, scratch / "out.####.obj");
    };
    const auto file = [&](const char* name, int frame, const char* ending) {
        return fmt::format("{}.{:04}.{}", scratch / name, frame, ending);
    };
    const auto same = [&](int frame, int in_source) {
        for (const auto& [name, ending] : {std::pair("drops", "ply"), {"bank", "obj"}})
            CHECK(difference_of(file("out", frame, ending), file(name, in_source, ending)) == "");
    };
    const auto cut = run(scratch, pipeline(scratch, "shorter", "1-21", "count: -5", ", join: cut",
                                           geometry(", join: cut")));
    INFO(cut.err);
    REQUIRE(cut.code == 0);
    for (const int frame : {1, 6}) same(frame, frame);
    for (const int frame : {10, 16}) same(frame, frame + 5);
    for (const auto* const ending : {"ply", "obj"})
        CHECK_FALSE(std::filesystem::exists(file("out", 17, ending)));

    const auto soft =
        run(scratch, pipeline(scratch, "soft", "1-21", "count: -5", "", geometry("")));
    INFO(soft.err);
    REQUIRE(soft.code == 0);
    same(1, 1);
    same(16, 21);
    // What goes round never goes back, and never jumps, in what is left of the pause.
    double turn = 0;
    for (int frame = 1; frame <= 16; ++frame) {
        const auto text = Scratch::read(file("out", frame, "obj"));
        double x = 0, y = 0;
        REQUIRE(std::sscanf(text.c_str() + text.find("\nv ") + 1, "v %lf %lf", &x, &y) == 2);
        const double now = std::atan2(y, x);
        if (frame > 1) CHECK(now >= turn - 1e-6);
        if (frame > 1) CHECK(now <= turn + 2 * 2 * M_PI / 40);
        turn = now;
    }
}

TEST_CASE("frames that readers leave out make no false copies of others") {
    const Scratch scratch;
    write_resting(scratch, 5);
    auto text = Scratch::read(pipeline(scratch, "skip", "1-6", "count: -1"));
    text.replace(text.find("type: vdb.read,"), 15, "type: vdb.read, missing: skip,");
    const auto ran = run(scratch, scratch.write("skip.yaml", text));
    CHECK(ran.code == 1);
    CHECK_THAT(ran.err, Catch::Contains("the carve leaves 1-4; let `missing: hold` of the reader"));
}

TEST_CASE("what can't take seams of frames, and what they can't do, is told before a run") {
    const Scratch scratch;
    write_resting(scratch, 6);
    const auto said = [&](const std::string& frames, const std::string& seams,
                          const std::string& remap = "", const std::string& more = "") {
        const auto ran =
            fluidcarve_program("check " + pipeline(scratch, "wrong", frames, seams, remap, more));
        CHECK(ran.code == 2);
        return ran.err;
    };
    CHECK_THAT(said("1-6", "count: -6"),
               Catch::Contains("wrong.yaml:8:3: count -6 takes all of 6 frames; some must stay"));
    CHECK_THAT(said("1-6", "count: -5"),
               Catch::Contains("5 seams do not fit: window [1, 4] has room to remove 4, since the "
                               "first and the last frame stay; ask for fewer"));
    CHECK_THAT(said("1-6", "count: 6"),
               Catch::Contains("6 seams do not fit: window [1, 4] has room to insert 4, since"));
    CHECK_THAT(said("1-6", "count: -3, window: [2, 3]"),
               Catch::Contains("3 seams do not fit: window [2, 3] has room to remove 2"));
    CHECK_THAT(said("1-6", "count: -1", ", conserve: mass"),
               Catch::Contains("'conserve' has no effect on seams of frames"));
    CHECK_THAT(
        said("1-6", "count: -1", ", join: cut, transform_vectors: true"),
        Catch::Contains("'transform_vectors' has no effect where frames are cut or blended"));
    scratch.write("still.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    CHECK_THAT(said("1-6", "count: -1", "",
                    fmt::format("  still: {{type: mesh.read, path: {}}}\n"
                                "  less: {{type: remap.mesh, source: still, lattice: box, seams: "
                                "seams}}\n",
                                scratch / "still.obj")),
               Catch::Contains("remap.mesh has a source that is the same in all frames"));
    CHECK_THAT(said("1-3,5-6", "count: -1"),
               Catch::Contains("all frames are needed, but between 3 and 5 some are left out"));
    CHECK_THAT(said("1-6", "count: -1", ", soft_time: 2"),
               Catch::Contains("`soft_time` has no effect on seams of frames"));
    CHECK_THAT(said("1-6", "count: -1", "",
                    "  thin: {type: seam.greedy, energy: edges, lattice: box, count: -1}\n"
                    "  both: {type: remap.grids, source: sim, lattice: box, seams: [thin, "
                    "seams]}\n"),
               Catch::Contains("takes seams of frames (`axis: t`) alone"));
    CHECK_THAT(
        said("1-6", "count: -1", "",
             "  smooth: {type: filter.seam, source: sim, lattice: box, seams: seams}\n"),
        Catch::Contains("filter.seam input 'seams' takes 'seams', but these are seams of frames "
                        "(`axis: t`): remap.grids, remap.points and remap.mesh carve them, "
                        "seams.write writes them, and no other node takes them"));
    CHECK_THAT(said("1-6", "count: -1, best_effort: true"),
               Catch::Contains("the number of frames must be known before the run"));
}
