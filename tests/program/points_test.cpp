#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace {

const std::string river = TEST_DATA "/river/river.0043.vdb";

/// A pipeline that reads points, shifts them by a seam and writes them, over the files `in.####` of
/// a scratch folder.
struct PointsBench {
    Scratch scratch;
    explicit PointsBench(const std::string& ending) {
        scratch.write(
            "p.yaml",
            "fluidcarve: 1\nframes: 43-44\nnodes:\n"
            "  points: {type: points.read, path: in.####." +
                ending +
                "}\n"
                "  box: {type: lattice.box, min: [0, 0, 0], max: [5, 5, 5], spacing: 0.25}\n"
                "  distance: {type: sdf.from_points, points: points, voxel_size: 0.25}\n"
                "  energy: {type: energy.surface, surface: distance}\n"
                "  seams: {type: seam.greedy, energy: energy, lattice: box, count: -2, window: "
                "[11, 14]}\n"
                "  carved: {type: remap.points, source: points, lattice: box, seams: seams}\n"
                "  out: {type: points.write, source: carved, path: " +
                (scratch / "out/o.####.") + ending + "}\n");
    }
    Called run(const std::string& options = "") const {
        return fluidcarve_program("run " + (scratch / "p.yaml") + " --progress none --work " +
                                  (scratch / "work") + " " + options);
    }
};

}  // namespace

TEST_CASE(
    "particles are read, carved by seams of their own surface, and written, and the report counts "
    "them") {
    const PointsBench bench("vdb");
    for (const auto* const frame : {"43", "44"})
        std::filesystem::copy(std::string(TEST_DATA "/river/river.00") + frame + ".vdb",
                              bench.scratch / (std::string("in.00") + frame + ".vdb"));
    const auto called = bench.run("--report " + (bench.scratch / "r.json"));
    INFO(called.err);
    REQUIRE(called.code == 0);
    CHECK(std::filesystem::exists(bench.scratch / "out/o.0044.vdb"));
    const auto report = nlohmann::json::parse(Scratch::read(bench.scratch / "r.json"));
    for (const auto* const frame : {"43", "44"}) {
        const auto& counts = report["points"]["carved"][frame];
        CHECK(counts["points"] > 10000);
        CHECK(counts["moved"] > 1000);
        CHECK(counts["deleted"] > 100);
        CHECK(counts["copied"] == 0);
    }
}

TEST_CASE(
    "files of points that can't be read end a run before its first frame, with exit code 3 and the "
    "reason") {
    const PointsBench vdb("vdb"), ply("ply");
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
        "float z\nend_header\n";
    ply.scratch.write("in.0043.ply", header + "1 2 3\n2 2 2\n");
    const auto refused = [](const PointsBench& bench, const std::string& reason) {
        const auto called = bench.run();
        INFO(called.err);
        CHECK(called.code == 3);
        CHECK(called.err.find(reason) != std::string::npos);
        CHECK_FALSE(std::filesystem::exists(bench.scratch / "out/o.0043.ply"));
    };
    refused(vdb,
            "in.0043.vdb does not exist, nor does in.0043.vdb in the current folder, nor does any "
            "other frame");
    refused(ply, "in.0044.ply does not exist");
    ply.scratch.write("in.0044.ply", header);
    refused(ply,
            "in.0044.ply is cut off: it states 2 vertices of 6 or more bytes, but has 0 bytes "
            "after its header");
    ply.scratch.write("in.0044.ply", header + "1 2 3\n2 2 nan\n");
    refused(ply, "in.0044.ply is damaged: the position of vertex 1 is not finite");

    const auto bytes = Scratch::read(river);
    vdb.scratch.write("in.0043.vdb", bytes);
    vdb.scratch.write("in.0044.vdb", bytes.substr(0, bytes.size() - 1000));
    refused(vdb, "in.0044.vdb is cut off");
    vdb.scratch.write("in.0044.vdb", Scratch::read(TEST_DATA "/plume/plume.0051.vdb"));
    refused(vdb, "in.0044.vdb has no points; it has velocity, density, shadow, temperature, flame");
}
