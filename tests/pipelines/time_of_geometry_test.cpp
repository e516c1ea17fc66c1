#include "tests/support/program.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>

// `time.retime` and `time.loop` of points and meshes, run by the program.

using namespace fluidcarve;

namespace {

constexpr int period = 8;

/// Writes two rounds of a ring of 20 particles, and of a triangle whose third corner goes round.
void write_rounds(const Scratch& scratch) {
    for (int frame = 1; frame <= 2 * period; ++frame) {
        const double turn = 2 * M_PI * frame / period;
        std::string points =
            "ply\nformat ascii 1.0\nelement vertex 20\nproperty double x\nproperty double y\n"
            "property double z\nproperty int id\nend_header\n";
        for (int n = 0; n < 20; ++n)
            points += fmt::format("{} {} 0 {}\n", n + 3 * std::cos(turn), 3 * std::sin(turn), n);
        scratch.write(fmt::format("drops.{:04}.ply", frame), points);
        scratch.write(
            fmt::format("bank.{:04}.obj", frame),
            fmt::format("v 0 0 0\nv 1 0 0\nv {} {} 1\nf 1 2 3\n", std::cos(turn), std::sin(turn)));
    }
}

Called timed(const Scratch& scratch, const std::string& node) {
    const auto pipeline = scratch.write(
        "time.yaml", fmt::format("fluidcarve: 1\nframes: 1-{}\nnodes:\n"
                                 "  drops: {{type: points.read, path: {}}}\n"
                                 "  bank: {{type: mesh.read, path: {}}}\n"
                                 "  drops_now: {{type: {}, source: drops}}\n"
                                 "  bank_now: {{type: {}, source: bank}}\n"
                                 "  out: {{type: points.write, source: drops_now, path: {}}}\n"
                                 "  out2: {{type: mesh.write, source: bank_now, path: {}}}\n",
                                 2 * period, scratch / "drops.####.ply", scratch / "bank.####.obj",
                                 node, node, scratch / "now.####.ply", scratch / "now.####.obj"));
    return call_shell(
        fmt::format("{} run {} --no-cache --progress none", FLUIDCARVE_PROGRAM, pipeline));
}

/// The lines of numbers in a file: points, or vertices and faces.
std::string numbers_in(const std::string& path) {
    std::ifstream in(path);
    std::string out;
    for (std::string line; std::getline(in, line);)
        if (!line.empty() && (line[0] == 'v' || line[0] == 'f' || line[0] == '-' ||
                              std::isdigit(static_cast<unsigned char>(line[0]))))
            out += line + "\n";
    return out;
}

std::string file(const Scratch& scratch, const std::string& name, int frame,
                 const std::string& ending) {
    return fmt::format("{}.{:04}.{}", scratch / name, frame, ending);
}

}  // namespace

TEST_CASE("time.retime and time.loop take points and meshes") {
    const Scratch scratch;
    write_rounds(scratch);
    const auto slow = timed(scratch, "time.retime, speed: 0.5");
    INFO(slow.err);
    REQUIRE(slow.code == 0);
    for (const int frame : {1, 5, 2 * period}) {
        CHECK(numbers_in(file(scratch, "now", 2 * frame - 1, "ply")) ==
              numbers_in(file(scratch, "drops", frame, "ply")));
        CHECK(numbers_in(file(scratch, "now", 2 * frame - 1, "obj")) ==
              numbers_in(file(scratch, "bank", frame, "obj")));
    }
    CHECK(numbers_in(file(scratch, "now", 2, "obj")) != numbers_in(file(scratch, "now", 1, "obj")));

    const auto loop = timed(scratch, fmt::format("time.loop, frames: {}, loops: 2", period));
    INFO(loop.err);
    REQUIRE(loop.code == 0);
    CHECK(loop.err.find("fade") == std::string::npos);
    for (const auto* const ending : {"ply", "obj"})
        for (int frame = 1; frame <= period; ++frame)
            CHECK(numbers_in(file(scratch, "now", frame, ending)) ==
                  numbers_in(file(scratch, "now", frame + period, ending)));
    // What goes round goes on: the loop begins with a frame of the source, and keeps to its order.
    int first = 1;
    while (numbers_in(file(scratch, "bank", first, "obj")) !=
           numbers_in(file(scratch, "now", 1, "obj")))
        REQUIRE(++first <= period + 1);
    CHECK(numbers_in(file(scratch, "now", 4, "obj")) ==
          numbers_in(file(scratch, "bank", first + 3, "obj")));
    CHECK(numbers_in(file(scratch, "now", 4, "ply")) ==
          numbers_in(file(scratch, "drops", first + 3, "ply")));
}

TEST_CASE("a loop of a mesh whose faces change is refused with its frame and a remedy") {
    const Scratch scratch;
    write_rounds(scratch);
    scratch.write("bank.0005.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n");
    const auto ran = timed(scratch, "time.loop, frames: 8");
    CHECK(ran.code != 0);
    CHECK_THAT(ran.err,
               Catch::Contains("change between frame 4 and 5") && Catch::Contains("sdf.to_mesh"));
}

TEST_CASE("a curve of frames is read from a CSV file") {
    const Scratch scratch;
    write_rounds(scratch);
    const auto at_curve = [&](const std::string& text) {
        return timed(scratch, "time.retime, curve_file: " + scratch.write("curve.csv", text));
    };
    REQUIRE(at_curve("\"frame\",\"source\"\r\n\"1\",2\r\n3,6\r\n# held\r\n5,6\r\n").code == 0);
    for (const auto& [frame, shows] : {std::pair(1, 2), {2, 4}, {3, 6}, {5, 6}})
        CHECK(numbers_in(file(scratch, "now", frame, "obj")) ==
              numbers_in(file(scratch, "bank", shows, "obj")));
    CHECK_THAT(at_curve("l1,2\n3,6\n").err, Catch::Contains("curve.csv:1"));
    CHECK_THAT(at_curve("1 2\n3\n").err,
               Catch::Contains("curve.csv:2") && Catch::Contains("needs two numbers"));
    CHECK_THAT(at_curve("1;2\n1;3\n").err,
               Catch::Contains("curve.csv:2") && Catch::Contains("must rise, but 1 follows 1"));
    CHECK_THAT(at_curve("frame, source\n").err, Catch::Contains("there are no points in it"));
    CHECK_THAT(at_curve("1 2\n9 400\n").err, Catch::Contains("400"));
    CHECK_THAT(timed(scratch, "time.retime, curve_file: " + scratch / "none.csv").err,
               Catch::Contains("none.csv"));
}
