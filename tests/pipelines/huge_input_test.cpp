#include "formats/vdb/vdb_file.h"
#include "tests/support/program.h"

#include <nlohmann/json.hpp>

#include <catch2/catch.hpp>

#include <filesystem>
#include <limits>

using namespace fluidcarve;
using openvdb::Coord;

// Small files that hold more than any machine.

namespace {

/// A file with one grid, `density`, and a pipeline that reads it and has these further nodes.
class HugeShot {
public:
    HugeShot(const FloatGrid::Ptr& grid, const std::string& nodes) {
        grid->setName("density");
        write_vdb(scratch_ / "in.vdb", {{grid}, {}, {}});
        CHECK(std::filesystem::file_size(scratch_ / "in.vdb") < 40000);
        scratch_.write(
            "p.yaml",
            "fluidcarve: 1\nparams:\n  to: {type: path, default: \"" + scratch_.path() +
                "\"}\nnodes:\n  sim: {type: vdb.read, path: in.vdb, grids: {density: float}}\n" +
                nodes);
    }
    Called call(const std::string& verb, const std::string& more = {}) const {
        return fluidcarve_program(verb + " " + (scratch_ / "p.yaml") + " --memory 1G " + more);
    }

private:
    Scratch scratch_;
};

FloatGrid::Ptr voxels_at(const std::vector<Coord>& places) {
    const auto out = FloatGrid::create();
    for (const auto& at : places) out->tree().setValue(at, 1.0f);
    return out;
}

constexpr int lowest = std::numeric_limits<int>::min(), highest = std::numeric_limits<int>::max();

}  // namespace

TEST_CASE("voxels at both ends of index space end a run with a message") {
    const auto refused = [](const std::string& nodes, const std::string& message) {
        const auto ran = HugeShot(voxels_at({{lowest, 0, 0}, {highest, 0, 0}}), nodes)
                             .call("run", "--progress none");
        INFO(nodes << ran.err);
        CHECK(ran.code == 3);
        CHECK(ran.err.find(message) != std::string::npos);
    };
    const std::string span =
        "the active voxels of grid 'density' span [-2147483648, 0, 0] to [2147483647, 0, 0]: "
        "4294967296 x 1 x 1 voxels; ";
    refused(
        "  box: {type: lattice.box, fit: sim.density}\n  out: {type: lattice.write, lattice: box, "
        "path: \"${to}/box.obj\"}\n",
        span +
            "65534 along an axis is the most: crop the grid, or state 'min', 'max' and 'spacing' "
            "of a part");
    refused(
        "  energy: {type: energy.gradient, field: sim.density}\n  out: {type: vdb.write, source: "
        "energy, path: \"${to}/out.vdb\"}\n",
        span + "voxel 1000000000 is the farthest: crop the grid");
    refused("  sheet: {type: preview.sheet, before: sim, path: \"${to}/sheet.png\"}\n",
            span + "voxel 1000000000 is the farthest: crop the grid");
}

TEST_CASE("a carve passes by voxels at both ends of index space") {
    const HugeShot shot(
        voxels_at({Coord(lowest), {2, 2, 2}, Coord(highest)}),
        "  box: {type: lattice.box, min: [0, 0, 0], max: [7, 7, 7], spacing: 1}\n"
        "  seams: {type: seam.pyramid, energy: sim.density, lattice: box, axis: u, count: -2}\n"
        "  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}\n"
        "  out: {type: vdb.write, source: carved, path: \"${to}/out.vdb\"}\n");
    const auto ran = shot.call("run", "--progress none");
    INFO(ran.err);
    CHECK(ran.code == 0);
}

TEST_CASE("a tile of 4096^3 voxels is forecast as voxels, and refused as such") {
    const auto grid = FloatGrid::create();
    grid->tree().root().addTile(Coord(0), 1.0f, true);
    const HugeShot shot(grid,
                        "  energy: {type: energy.gradient, field: sim.density}\n  out: {type: "
                        "vdb.write, source: energy, path: \"${to}/out.vdb\"}\n");
    const auto planned = shot.call("plan", "--json");
    REQUIRE(planned.code == 0);
    CHECK(nlohmann::json::parse(planned.out).at("bytes").get<double>() > 2.7e11);
    const auto ran = shot.call("run", "--progress none");
    CHECK(ran.code == 3);
    CHECK_THAT(
        ran.err,
        Catch::Contains("grid 'density' has 68719476736 active voxels, 68719476736 of them in "
                        "tiles; as voxels these would take "
                        "275 GB, but --memory allows 1.07 GB: crop the grid, or raise --memory"));
}
