#include "tests/support/program.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <regex>

// What a run says of its result.

namespace {

using nlohmann::json;

/// Two frames of the plume, narrowed.
struct ResultShot {
    const Scratch scratch;

    ResultShot() {
        scratch.write(
            "p.yaml",
            "fluidcarve: 1\nframes: 51-52\nnodes:\n  sim: {type: vdb.read, path: \"" TEST_DATA
            "/plume/plume.####.vdb\", grids: {density: float}}\n"
            "  energy: {type: energy.gradient, field: sim.density}\n"
            "  box: {type: lattice.box, fit: sim.density}\n"
            "  seams: {type: seam.greedy, energy: energy, field: sim.density, lattice: box, axis: "
            "u, count: -2}\n"
            "  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}\n"
            "  out: {type: vdb.write, source: carved, path: \"" +
                (scratch / "o.####.vdb") + "\"}\n");
    }
    Called run(const std::string& more = {}) const {
        return fluidcarve_program("run " + (scratch / "p.yaml") + " --progress none --work " +
                                  (scratch / "work") + " --report " + (scratch / "report.json") +
                                  " " + more);
    }
    json report() const { return json::parse(Scratch::read(scratch / "report.json")); }
};

/// The lines of a message that begin so.
std::string lines_with(const std::string& text, const std::string& begin) {
    std::string out;
    for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
        end = std::min(text.find('\n', at), text.size());
        if (text.compare(at, begin.size(), begin) == 0) out += text.substr(at, end - at) + "\n";
    }
    return out;
}

}  // namespace

TEST_CASE(
    "a run ends with a line for each carved grid, and a later run that computes nothing says the "
    "same") {
    const ResultShot shot;
    const auto first = shot.run("--threads 1");
    REQUIRE(first.code == 0);
    const auto told = lines_with(first.err, "carved: ");
    CHECK_THAT(told, Catch::Contains("carved: density 1.91 x "));
    CHECK(std::regex_match(
        lines_with(told, "carved: density "),
        std::regex(
            R"(carved: density [\d.]+ x [\d.]+ x [\d.]+ -> [\d.]+ x [\d.]+ x [\d.]+, mass -[\d.]+ %, highest [\d.]+ of before\n)")));
    const auto report = shot.report();
    const auto& density = report["grids"]["carved"]["density"];
    CHECK(density["frames"] == 2);
    for (const auto* const side : {"before", "after"})
        for (const auto* const field : {"box", "mass", "highest", "centre", "flicker"})
            CHECK(density[side].contains(field));
    CHECK(density["after"]["mass"].get<double>() < density["before"]["mass"].get<double>());
    CHECK(report["grids_by_frame"]["carved"]["51"]["density"]["before"]["mass"].get<double>() ==
          Approx(1.051637).epsilon(1e-5));

    const auto again = shot.run();
    CHECK(lines_with(again.err, "carved: ") == told);
    CHECK(shot.report()["nodes"]["out"]["cached"] == 2);
    CHECK(shot.report()["grids"] == report["grids"]);
    CHECK(lines_with(shot.run("-q").err, "carved: ").empty());

    REQUIRE(shot.run("--threads 4 --no-cache").code == 0);
    CHECK(shot.report()["grids"] == report["grids"]);
    CHECK(shot.report()["grids_by_frame"] == report["grids_by_frame"]);
}

TEST_CASE("a lattice beside the content is warned of") {
    const ResultShot shot;
    auto text = Scratch::read(shot.scratch / "p.yaml");
    const std::string box = "box: {type: lattice.box, fit: sim.density}";
    text.replace(text.find(box), box.size(),
                 "rig: {type: rig.points, points: [[2.85, 0, 1], [2.85, 2, 1]]}\n  box: {type: "
                 "lattice.build, rig: rig, spacing: 0.1, extent_u: [-0.95, 0.95], "
                 "extent_v: "
                 "[-1, 1]}");
    const std::string count = "count: -2";
    text.replace(text.find(count), count.size(), count + ", anchor: high");
    shot.scratch.write("p.yaml", text);
    const auto beside = shot.run();
    REQUIRE(beside.code == 0);
    CHECK_THAT(beside.err,
               Catch::Contains("warning: carved (remap.grids): the carve changed nothing in "
                               "density, shadow, temperature; if the lattice lies beside it, "));
    CHECK_THAT(lines_with(beside.err, "carved: "), Catch::StartsWith("carved: density 1.91 x "));
    CHECK_THAT(beside.err, Catch::Contains(", nothing changed\n"));
}
