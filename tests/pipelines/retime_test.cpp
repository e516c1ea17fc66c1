#include "formats/points_file/points_file.h"
#include "tests/support/files/vdb_sequences.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

namespace fs = std::filesystem;

/// Runs a pipeline with the plume as `sim`, which goes through `slow` into `NAME.####.vdb`.
/// @return what was told on stderr
std::string retimed(const Scratch& scratch, const std::string& name, const std::string& frames,
                    const std::string& params, const std::string& options = "",
                    const std::string& more = "", int code = 0) {
    const auto pipeline = scratch.write(
        name + ".yaml",
        fmt::format(
            "fluidcarve: 1\nframes: {}\nnodes:\n"
            "  sim: {{type: vdb.read, path: {}, grids: {{density: float, velocity: vector}}}}\n"
            "  slow: {{type: time.retime, source: sim, velocity: sim.velocity, {}}}\n"
            "  out: {{type: vdb.write, source: slow, path: {}.####.vdb}}\n{}",
            frames, SOURCE_ROOT "/tests/data/plume/plume.####.vdb", params, scratch / name, more));
    const auto ran =
        call_shell(fmt::format("{} run {} --progress none --work {} {}", FLUIDCARVE_PROGRAM,
                               pipeline, scratch / "work", options));
    INFO(ran.err);
    CHECK(ran.code == code);
    return ran.err;
}

}  // namespace

TEST_CASE(
    "a plume at speed 1 is the same bit for bit, and at half the speed each of its frames comes "
    "back",
    "[long]") {
    const Scratch scratch;
    const std::string plume = SOURCE_ROOT "/tests/data/plume/plume";
    retimed(scratch, "same", "51-53", "speed: 1");
    for (int frame = 51; frame <= 53; ++frame)
        CHECK(difference_of(file_at(plume, frame), file_at(scratch / "same", frame)) == "");
    retimed(scratch, "slow", "51-53", "speed: 0.5");
    for (int frame = 51; frame <= 53; ++frame) {
        const auto said =
            difference_of(file_at(plume, frame), file_at(scratch / "slow", 2 * frame - 51));
        for (const std::string grid : {"density", "temperature", "flame", "shadow"})
            CHECK_THAT(said, Catch::Contains(grid + ": the same"));
        CHECK_THAT(said, Catch::Contains("velocity: different"));
    }
    CHECK(fs::exists(file_at(scratch / "slow", 55)));
    CHECK_FALSE(fs::exists(file_at(scratch / "slow", 56)));
    CHECK_THAT(retimed(scratch, "slow", "51-53", "speed: 0.5"),
               Catch::Contains("nothing had to be done"));
}

TEST_CASE("frames that were left out are made again better than by blending", "[long]") {
    const Scratch scratch;
    retimed(scratch, "made", "51-55x2", "speed: 0.5");
    double made = 0, blended = 0, before = 0, after = 0;
    for (const int frame : {52, 54}) {
        const auto truth = density_in(file_at(SOURCE_ROOT "/tests/data/plume/plume", frame));
        const auto a = density_in(file_at(SOURCE_ROOT "/tests/data/plume/plume", frame - 1)),
                   b = density_in(file_at(SOURCE_ROOT "/tests/data/plume/plume", frame + 1));
        const auto blend = a->deepCopy();
        blend->tree().topologyUnion(b->tree());
        for (auto value = blend->beginValueOn(); value; ++value)
            value.setValue(0.5f * (a->tree().getValue(value.getCoord()) +
                                   b->tree().getValue(value.getCoord())));
        // On twos, frame 51 + 2 n shows frame 51 + n.
        const auto got = density_in(file_at(scratch / "made", 51 + 2 * (frame - 51)));
        made += squared_difference(*got, *truth);
        blended += squared_difference(*blend, *truth);
        for (auto value = got->cbeginValueOn(); value; ++value) before += *value;
        for (const auto& each : {a, b})
            for (auto value = each->cbeginValueOn(); value; ++value) after += 0.5 * *value;
    }
    CHECK(std::sqrt(made / blended) < 0.65);
    CHECK(before == Approx(after).epsilon(0.01));
}

TEST_CASE("retimed frames are the same bytes whatever the threads, the memory and the part of them",
          "[nightly][long]") {
    const Scratch scratch;
    retimed(scratch, "wanted", "51-53", "speed: 0.5", "--no-cache");
    retimed(scratch, "alone", "51-53", "speed: 0.5", "--no-cache --threads 1 --in-flight 1");
    retimed(scratch, "part", "51-53", "speed: 0.5", "--no-cache -f 52,54");
    CHECK_FALSE(fs::exists(file_at(scratch / "part", 53)));
    for (int frame = 51; frame <= 55; ++frame)
        CHECK(difference_of(file_at(scratch / "wanted", frame),
                            file_at(scratch / "alone", frame)) == "");
    for (const int frame : {52, 54})
        CHECK(difference_of(file_at(scratch / "wanted", frame), file_at(scratch / "part", frame)) ==
              "");
}

TEST_CASE(
    "a solver behind a change of time sees its frames, and what meets must have the same ones",
    "[long]") {
    const Scratch scratch;
    const std::string carve =
        "  edges: {type: energy.gradient, field: slow.density}\n"
        "  box: {type: lattice.box, fit: slow.density}\n"
        "  seams: {type: seam.greedy, energy: edges, lattice: box, axis: u, count: -2}\n"
        "  carved: {type: remap.grids, source: slow, lattice: box, seams: seams}\n";
    retimed(scratch, "both", "51-52", "speed: 0.5", "--report " + scratch / "r.json",
            carve + "  more: {type: vdb.write, source: carved, path: " + scratch / "carved" +
                ".####.vdb}\n");
    for (int frame = 51; frame <= 53; ++frame)
        CHECK(fs::exists(file_at(scratch / "carved", frame)));
    CHECK_THAT(Scratch::read(scratch / "r.json"), Catch::Contains("\"shape\""));
    CHECK_THAT(retimed(scratch, "mixed", "51-52", "speed: 0.5", "",
                       "  both: {type: energy.combine, terms: [sim.density, slow.density]}\n", 2),
               Catch::Contains("'sim' has the frames 51,52, but 'slow' has 51-53: take both from "
                               "before the change of time, or both from behind it"));
    CHECK_THAT(retimed(scratch, "beyond", "51-52", "curve: [[1, 51], [9, 60]]", "", "", 2),
               Catch::Contains(
                   "the curve leads to frame 60 of the source, which has the frames 51 to 52"));
    CHECK_THAT(retimed(scratch, "none", "51-52", "start: 3", "", "", 2),
               Catch::Contains("needs a 'speed', a number of 'frames', or a 'curve'"));
}

TEST_CASE(
    "a river in slow motion: particles and surface have the same frames, of which its own stay",
    "[long]") {
    const Scratch scratch;
    const auto ran =
        call_shell(fmt::format("{} run {}/pipelines/river_slow.yaml --progress none --work {} "
                               "--set out={}.####.vdb --set skin={}.####.vdb --report {}",
                               FLUIDCARVE_PROGRAM, SOURCE_ROOT, scratch / "work", scratch / "slow",
                               scratch / "skin", scratch / "report.json"));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    const std::string river = SOURCE_ROOT "/tests/data/river/meander";
    // Their velocity is half as fast; the points are where they were.
    const auto at = [](const std::string& path) {
        return read_points(path, "", PointOffset::half_voxel, {}).positions();
    };
    CHECK(at(file_at(scratch / "slow", 39)) == at(file_at(river, 38)));
    const auto between = at(file_at(scratch / "slow", 38)).size(),
               before = at(file_at(river, 37)).size(), after = at(file_at(river, 38)).size();
    CHECK(between == Approx(0.5 * (before + after)).epsilon(0.02));
    CHECK(fs::exists(file_at(scratch / "skin", 41)));
    // Blender's unit of velocity: a tenth of a voxel per frame.
    const auto report = nlohmann::json::parse(Scratch::read(scratch / "report.json"));
    CHECK(report["retime"]["moved"]["scale"].get<double>() == Approx(0.00625).epsilon(0.05));
}
