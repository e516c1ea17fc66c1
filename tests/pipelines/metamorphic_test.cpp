// Relations between two runs, which need no third that knows the right result.

#include "tests/support/files/vdb_sequences.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

namespace fs = std::filesystem;

constexpr int frame_a = 51, frame_b = 54;  ///< the frames carved

/// Carves the frames by the pipeline that `carve` writes for them.
/// @param arguments  of `carve`  @param more  of `run`  @return the carved sequence
std::string carved(const Scratch& scratch, const std::string& name, const std::string& input,
                   const std::string& arguments, const std::string& more = "") {
    const auto out = scratch / name + ".####.vdb", pipeline = scratch / name + ".yaml";
    const auto written =
        call_shell(fmt::format("{} carve {} {} -o {} --print-pipeline > {}", FLUIDCARVE_PROGRAM,
                               input, arguments, out, pipeline));
    INFO(written.err);
    REQUIRE(written.code == 0);
    const auto ran =
        call_shell(fmt::format("{} run {} --progress none --work {} {}", FLUIDCARVE_PROGRAM,
                               pipeline, scratch / name + "_work", more));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    return out;
}

/// Copies the plume's frames. @param from  the frame that becomes this one
template <class From>
std::string copied(const Scratch& scratch, const std::string& name, const From& from) {
    for (int frame = frame_a; frame <= frame_b; ++frame)
        fs::copy_file(file_at(SOURCE_ROOT "/tests/data/plume/plume", from(frame)),
                      file_at(scratch / name, frame));
    return scratch / name + ".####.vdb";
}

int same_frame(int frame) { return frame; }

/// Sum of the energies of all seams in a report.
double total_energy(const std::string& report) {
    std::ifstream in(report);
    const auto all = nlohmann::json::parse(in);
    double out = 0;
    for (const auto& [name, seams] : all["seams"].items())
        for (const auto& each : seams["energy"]) out += each.get<double>();
    return out;
}

}  // namespace

TEST_CASE("neither threads nor frames in flight nor memory changes a byte of a carve",
          "[nightly][long]") {
    for (const std::string arguments : {"-8", "-8 --warp", "6 --solver greedy"}) {
        INFO(arguments);
        const Scratch scratch;
        const auto input = copied(scratch, "in", same_frame);
        const auto wanted = carved(scratch, "wanted", input, arguments, "--threads 2");
        CHECK(difference_of(wanted, carved(scratch, "alone", input, arguments,
                                           "--threads 1 --in-flight 1")) == "");
        CHECK(difference_of(wanted, carved(scratch, "crowd", input, arguments,
                                           "--threads 2 --in-flight 9")) == "");
        CHECK(difference_of(wanted, carved(scratch, "scarce", input, arguments, "--memory 64M")) ==
              "");
    }
}

TEST_CASE("a grid that has nothing to do with a carve changes nothing but itself",
          "[nightly][long]") {
    const Scratch scratch;
    openvdb::initialize();
    const auto alone = carved(scratch, "alone", copied(scratch, "in", same_frame), "-8");
    const auto input = copied(scratch, "more", same_frame);
    for (int frame = frame_a; frame <= frame_b; ++frame) {
        openvdb::io::File file(file_at(scratch / "more", frame));
        file.open(false);
        auto grids = *file.getGrids();
        file.close();
        auto other = openvdb::FloatGrid::create();
        other->setName("other");
        other->setTransform(grids.front()->transform().copy());
        for (int n = 0; n < 500; ++n)
            other->tree().setValue(openvdb::Coord(n % 40, n % 37, n % 80),
                                   static_cast<float>(n + frame));
        grids.push_back(other);
        openvdb::io::File(file_at(scratch / "more", frame)).write(grids);
    }
    const auto said = difference_of(alone, carved(scratch, "together", input, "-8"));
    for (const std::string grid : {"velocity", "density", "shadow", "temperature", "flame"})
        CHECK_THAT(said, Catch::Contains(grid + ": the same"));
    CHECK_THAT(said, Catch::Contains("other: different"));
}

TEST_CASE(
    "exact seams of a sequence that stands still cost what static ones cost, and those of one that "
    "runs backwards what they cost forwards",
    "[nightly][long]") {
    const Scratch scratch;
    const auto cost = [&](const std::string& name, const std::string& input, bool is_static) {
        scratch.write(
            name + ".yaml",
            fmt::format("fluidcarve: 1\nframes: {}-{}\nnodes:\n"
                        "  sim: {{type: vdb.read, path: {}, grids: {{density: float}}}}\n"
                        "  energy: {{type: energy.gradient, field: sim.density}}\n"
                        "  box: {{type: lattice.box, fit: sim.density}}\n"
                        "  seams: {{type: seam.graph_cut, energy: energy, lattice: box, count: -1, "
                        "static: {}}}\n"
                        "  kept: {{type: seams.write, seams: seams, path: {}}}\n",
                        frame_a, frame_b, input, is_static, scratch / name + "_seams.vdb"));
        const auto report = scratch / name + ".json";
        const auto ran =
            call_shell(fmt::format("{} run {} --no-cache --progress none --report {}",
                                   FLUIDCARVE_PROGRAM, scratch / name + ".yaml", report));
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        return total_energy(report);
    };
    const auto still = copied(scratch, "still", [](int) { return frame_a; });
    CHECK(cost("moving", still, false) == Approx(cost("static", still, true)).epsilon(1e-4));
    const auto backwards =
        copied(scratch, "backwards", [](int frame) { return frame_a + frame_b - frame; });
    CHECK(cost("back", backwards, false) ==
          Approx(cost("on", copied(scratch, "in", same_frame), false)).epsilon(1e-4));
}

TEST_CASE(
    "a part of the frames is what it is in all of them, and fewer seams are the first of more",
    "[nightly][long]") {
    const Scratch scratch;
    const auto input = copied(scratch, "in", same_frame);
    carved(scratch, "all", input, "-8");
    carved(scratch, "part", input, "-8", "-f 52,54");
    CHECK_FALSE(fs::exists(file_at(scratch / "part", 51)));
    for (const int frame : {52, 54})
        CHECK(difference_of(file_at(scratch / "all", frame), file_at(scratch / "part", frame)) ==
              "");
    CHECK(difference_of(carved(scratch, "four", input, "-4"),
                        carved(scratch, "of_eight", input, "-8", "--set carved.count=4")) == "");
}

TEST_CASE("planes of a box leave as rows of the turned box do, bit for bit", "[nightly][long]") {
    const Scratch scratch;
    const auto input = copied(scratch, "in", same_frame);
    const auto carve = [&](const std::string& name, const std::string& axes,
                           const std::string& axis, const std::string& seams) {
        scratch.write(
            name + ".yaml",
            fmt::format(
                "fluidcarve: 1\nframes: {}-{}\nnodes:\n"
                "  sim: {{type: vdb.read, path: {}, grids: {{density: float, velocity: vector}}}}\n"
                "  energy: {{type: energy.gradient, field: sim.density}}\n"
                "  box: {{type: lattice.box, fit: sim.density, axes: {}}}\n"
                "  seams: {{{}, energy: energy, field: sim.density, lattice: box, axis: {}}}\n"
                "  carved: {{type: remap.grids, source: sim, lattice: box, seams: seams}}\n"
                "  out: {{type: vdb.write, source: carved, path: {}}}\n",
                frame_a, frame_b, input, axes, seams, axis, scratch / name + ".####.vdb"));
        const auto ran = call_shell(fmt::format("{} run {} --no-cache --progress none",
                                                FLUIDCARVE_PROGRAM, scratch / name + ".yaml"));
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        return scratch / name + ".####.vdb";
    };
    for (const std::string seams :
         {"type: seam.pyramid, count: -9", "type: seam.greedy, count: 7, anchor: high",
          "type: seam.pyramid, count: 8, thickness: auto", "type: warp.solve, amount: -6.5"}) {
        INFO(seams);
        CHECK(difference_of(carve("along", "xyz", "w", seams),
                            carve("turned", "xzy", "v", seams)) == "");
    }
}
