#include "tests/support/files/vdb_sequences.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

// `time.loop`, run by the program on a puff of smoke.

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

/// Writes frames 1 to `last` of a puff that is at a place, voxels.
template <class Place>
void write_puffs(const Scratch& scratch, int last, const Place& place) {
    for (int frame = 1; frame <= last; ++frame)
        openvdb::io::File(file_at(scratch / "puff", frame)).write({puff_around(place(frame))});
}

/// A way round, once in so many frames.
auto circling(double period) {
    return [period](int frame) {
        return 8.0 *
               Vec3d(std::cos(2 * M_PI * frame / period), std::sin(2 * M_PI * frame / period), 0);
    };
}

Called loop(const Scratch& scratch, int last, const std::string& params,
            const std::string& options = "") {
    const auto pipeline = scratch.write(
        "loop.yaml",
        fmt::format("fluidcarve: 1\nframes: 1-{}\nnodes:\n"
                    "  sim: {{type: vdb.read, path: {}, grids: {{density: float}}}}\n"
                    "  loop: {{type: time.loop, source: sim, {}}}\n"
                    "  out: {{type: vdb.write, source: loop, path: {}}}\n",
                    last, scratch / "puff.####.vdb", params, scratch / "out.####.vdb"));
    return call_shell(fmt::format("{} run {} --no-cache --progress none --report {} {}",
                                  FLUIDCARVE_PROGRAM, pipeline, scratch / "report.json", options));
}

double puff_off(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    return std::sqrt(squared_difference(a, b));
}

}  // namespace

TEST_CASE("a loop of a motion that repeats is that motion, as often as it is asked for") {
    const Scratch scratch;
    write_puffs(scratch, 21, circling(12));
    const auto ran = loop(scratch, 21, "frames: 12, loops: 2, start: 101");
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK(ran.err.find("warning") == std::string::npos);
    const auto told = nlohmann::json::parse(Scratch::read(scratch / "report.json"))["loop"]["loop"];
    CHECK(told["fade"] == 3);
    CHECK(told["difference"].get<double>() < 0.01);
    const int first = told["first"];
    for (int n = 0; n < 24; ++n) {
        const auto source = density_in(file_at(scratch / "puff", first + n % 12)),
                   out = density_in(file_at(scratch / "out", 101 + n));
        const auto all = puff_off(*source, *openvdb::FloatGrid::create());
        CHECK(puff_off(*source, *out) <= (n % 12 < 9 ? 0 : 0.01 * all));
    }
}

TEST_CASE(
    "a loop of a motion that does not repeat closes without a jump, and says that its fade will be "
    "seen") {
    const Scratch scratch;
    write_puffs(scratch, 16, [](int frame) { return Vec3d(0.5 * frame, 0.01 * frame * frame, 0); });
    const auto ran = loop(scratch, 16, "frames: 10, fade: 6");
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK_THAT(ran.err, Catch::Contains("loop (time.loop): the ends of the loop differ") &&
                            Catch::Contains("with `frames: 8` it would be"));
    double largest = 0, most = 0;
    for (int frame = 1; frame < 16; ++frame)
        largest = std::max(largest, puff_off(*density_in(file_at(scratch / "puff", frame)),
                                             *density_in(file_at(scratch / "puff", frame + 1))));
    for (int n = 0; n < 10; ++n)
        most = std::max(most, puff_off(*density_in(file_at(scratch / "out", 1 + n)),
                                       *density_in(file_at(scratch / "out", 1 + (n + 1) % 10))));
    CHECK(most < 1.2 * largest);
}

TEST_CASE("a loop that leaves nothing before it says that a frame is held") {
    const Scratch scratch;
    write_puffs(scratch, 12, circling(12));
    CHECK_THAT(loop(scratch, 12, "frames: 12").err,
               Catch::Contains("there are no frames of the source: its first frame is held"));
}

TEST_CASE(
    "of a range of lengths the one that closes best is taken, and goes round in the longest") {
    const Scratch scratch;
    write_puffs(scratch, 21, circling(12));
    const auto ran = loop(scratch, 21, "frames: [9, 15]");
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK(nlohmann::json::parse(Scratch::read(scratch / "report.json"))["loop"]["loop"]["frames"] ==
          12);
    CHECK(puff_off(*density_in(file_at(scratch / "out", 1)),
                   *density_in(file_at(scratch / "out", 13))) == 0);
    CHECK(std::filesystem::exists(file_at(scratch / "out", 15)));
    CHECK_FALSE(std::filesystem::exists(file_at(scratch / "out", 16)));
    CHECK_THAT(loop(scratch, 21, "frames: [15, 9]").err,
               Catch::Contains("'frames' must rise: [9, 15]"));
}

TEST_CASE("a loop that the sequence can't give is refused with its place") {
    const Scratch scratch;
    write_puffs(scratch, 6, circling(12));
    const auto said = [&](const std::string& params, int last = 6) {
        return loop(scratch, last, params).err;
    };
    CHECK_THAT(said("frames: 9"), Catch::Contains("loop.yaml:5:3: a loop of 9 frames needs as many "
                                                  "of the source, which has 6; lower 'frames'"));
    CHECK_THAT(
        said("frames: 4, fade: 4"),
        Catch::Contains(
            "a fade of 4 frames leaves none of the 4 frames of the loop as it is; lower it"));
    CHECK_THAT(said("frames: 1"), Catch::Contains("loop.yaml:5"));
    CHECK_THAT(loop(scratch, 6, "frames: 3", "-f 1").err,
               !Catch::Contains("all frames are needed"));
    auto text = Scratch::read(scratch / "loop.yaml");
    text.replace(text.find("frames: 1-6"), 11, "frames: 1-3,5-6");
    const auto gap = scratch.write("gap.yaml", text);
    CHECK_THAT(fluidcarve_program("check " + gap).err,
               Catch::Contains("all frames are needed, but between 3 and 5 some are left out"));
}
