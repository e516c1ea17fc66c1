#include "formats/vdb/vdb_file.h"
#include "tests/support/program.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;

// Ramps of a warp, measured in the files that the program writes.

namespace {

constexpr int wide = 60, deep = 8, high = 41;
const CoordBBox block(Coord(0), Coord(wide - 1, deep - 1, high - 1));

/// Density 0.5 to 1.5, without order.
FloatGrid::Ptr density(int frame) {
    const auto out = FloatGrid::create();
    out->setName("density");
    for (auto at = block.begin(); at; ++at)
        out->tree().setValueOn(
            *at, 0.5f + static_cast<float>(static_cast<unsigned>((*at).x() * 73 + (*at).y() * 19 +
                                                                 (*at).z() * 7 + frame * 31) *
                                           2654435761u % 1000) /
                            1000);
    return out;
}

/// Three frames of a block that fills its lattice.
struct Ramp {
    Scratch scratch;

    Ramp() {
        for (int frame = 1; frame <= 3; ++frame)
            write_vdb(scratch / fmt::format("in.{}.vdb", frame), {{density(frame)}, {}, {}});
    }
    /// @param seams  fields of the solver
    Called run(const std::string& verb, const std::string& seams) const {
        const auto pipeline = scratch.write(
            "p.yaml",
            "fluidcarve: 1\nframes: 1-3\nnodes:\n  sim: {type: vdb.read, path: " +
                (scratch / "in.#.vdb") +
                ", grids: {density: float}}\n"
                "  energy: {type: energy.gradient, field: sim.density}\n"
                "  box: {type: lattice.box, fit: sim.density}\n"
                "  seams: {type: warp.solve, energy: energy, field: sim.density, lattice: box, " +
                seams +
                "}\n"
                "  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}\n"
                "  out: {type: vdb.write, source: carved, path: " +
                (scratch / "out.#.vdb") + "}\n");
        return fluidcarve_program(verb + " " + pipeline + " --work " + (scratch / "work"));
    }
    void carve(const std::string& seams) const {
        const auto ran = run("run -q --progress none", seams);
        INFO(ran.err);
        REQUIRE(ran.code == 0);
    }
    FloatGrid::ConstPtr carved(int frame) const {
        return openvdb::gridConstPtrCast<FloatGrid>(
            read_vdb(scratch / fmt::format("out.{}.vdb", frame)).find("density"));
    }
};

/// How wide a row of voxels is: those at its ends count by how much is in them.
double width_of(const FloatGrid& grid, int y, int z) {
    int active = 0;
    for (int x = -2; x < 2 * wide; ++x) active += grid.tree().isValueOn({x, y, z});
    return active;
}

}  // namespace

TEST_CASE(
    "in written files widths follow a ramp within a voxel, and where it is 0 nothing moves, bit "
    "for bit") {
    const Ramp ramp;
    const std::string amount = "{along: w, at: [[0, 0], [0.3, 0], [1, -14.5]]}";
    ramp.carve("amount: " + amount);
    for (int frame = 1; frame <= 3; ++frame) {
        const auto before = density(frame),
                   after = openvdb::gridPtrCast<FloatGrid>(ramp.carved(frame)->deepCopyGrid());
        for (int n = 0; n < 10; ++n) {
            const int z = 4 * n + 4;
            const double wanted = wide - 14.5 * std::max(0.0, (z / 40.0 - 0.3) / 0.7);
            for (int y = 0; y < deep; ++y) CHECK(std::abs(width_of(*after, y, z) - wanted) <= 1);
        }
        for (auto at = CoordBBox(Coord(0), Coord(wide - 1, deep - 1, 12)).begin(); at; ++at) {
            REQUIRE(after->tree().isValueOn(*at));
            REQUIRE(after->tree().getValue(*at) == before->tree().getValue(*at));
        }
    }
}

TEST_CASE("amounts of one solve are those of own solves, and cost no search") {
    const Ramp ramp, own;
    ramp.carve("amount: -2");
    for (const std::string amount : {"-1.5", "-7.25", "4.5"}) {
        const auto planned =
            nlohmann::json::parse(ramp.run("plan --json", "amount: " + amount).out);
        CHECK(planned["nodes"]["seams"]["cached"] == planned["nodes"]["seams"]["frames"]);
        ramp.carve("amount: " + amount);
        own.carve("amount: " + amount);
        for (int frame = 1; frame <= 3; ++frame) {
            const auto one = ramp.carved(frame), other = own.carved(frame);
            CHECK(one->activeVoxelCount() == other->activeVoxelCount());
            for (auto value = one->cbeginValueOn(); value; ++value)
                REQUIRE(*value == Approx(other->tree().getValue(value.getCoord())).margin(1e-4));
        }
        std::filesystem::remove_all(own.scratch / "work");
    }
}

TEST_CASE("another amount in a file runs the warp anew, and the plan names the file") {
    const Ramp ramp;
    const auto file = ramp.scratch.write("ramp.csv", "w,amount\n0,0\n1,-6\n");
    ramp.carve("amount_file: " + file);
    ramp.scratch.write("ramp.csv", "w,amount\n0,0\n1,-5\n");
    const auto planned = nlohmann::json::parse(ramp.run("plan --json", "amount_file: " + file).out);
    CHECK(planned["nodes"]["seams"]["why"] == "input ramp.csv changed");
}
