#include "carve/rig/streaklines.h"
#include "nodes/rig.h"

#include "carve/rig/advect.h"
#include "tests/support/built_lattices.h"
#include "tests/support/sampled.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

using Lines = std::vector<std::vector<Vec3d>>;

/// The streaklines of a flow that moves all by (1, 0, 0) in each frame, from the origin on.
std::vector<Streakline> rising(std::size_t frames) {
    std::vector<Streakline> out;
    for (std::size_t t = 0; t <= frames; ++t) {
        Streakline line;
        for (std::size_t n = 0; n <= t; ++n) line.points.emplace_back(static_cast<double>(n), 0, 0);
        out.push_back(line);
    }
    return out;
}

double length_of(const std::vector<Vec3d>& line) {
    double out = 0;
    for (std::size_t n = 1; n < line.size(); ++n) out += (line[n] - line[n - 1]).length();
    return out;
}

/// The rigs of a moving rig.advect, and what it said.
struct Moving {
    std::vector<Ref<Rig>> rigs;
    Heard heard;

    Moving(const std::string& yaml, const std::vector<VectorGrid::Ptr>& flows,
           const std::vector<int>& frames) {
        NodeBench bench(rig_advect(), yaml);
        REQUIRE(bench.faults().empty());
        const auto input = [&](std::size_t t) {
            return NodeBench::Inputs{{"velocity", {Payload(flows[t])}}};
        };
        for (std::size_t t = 0; t < frames.size(); ++t)
            bench.add(input(t), Context(heard, frames).at(t));
        bench.finish(Context(heard, frames));
        for (std::size_t t = 0; t < frames.size(); ++t)
            rigs.push_back(bench.run(input(t), Context(heard, frames).at(t)).at("rig").as<Rig>());
    }
};

VectorGrid::Ptr uniform(const openvdb::Vec3s& velocity) {
    return sampled<VectorGrid>(CoordBBox(Coord(-40), Coord(80)), 0.25,
                               [=](const Vec3d&) { return velocity; });
}

/// A flow upwards that blows to one side and to the other.
std::vector<VectorGrid::Ptr> swaying(const std::vector<int>& frames) {
    std::vector<VectorGrid::Ptr> out;
    for (const int frame : frames)
        out.push_back(
            uniform(openvdb::Vec3s(static_cast<float>(std::sin(2 * M_PI * frame / 20)), 0, 1)));
    return out;
}

const std::vector<int> two_dozen{1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12,
                                 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24};

}  // namespace

TEST_CASE(
    "lines are as long in the first frames as in the last: they go on where the first points will "
    "go") {
    const auto lines = moving_lines(rising(5), {0.5, {}, 0});
    REQUIRE(lines.size() == 5);
    for (const auto& line : lines) {
        REQUIRE(line.size() == 11);
        for (std::size_t n = 0; n < line.size(); ++n)
            CHECK((line[n] - Vec3d(0.5 * static_cast<double>(n), 0, 0)).length() < 1e-12);
    }
    // Turned aside in the last frame: the first frame's line turns there, too.
    auto turned = rising(5);
    turned[5].points.back() = Vec3d(4, 1, 0);
    for (const auto& line : moving_lines(turned, {1, {}, 0})) {
        CHECK(line[4] == Vec3d(4, 0, 0));
        CHECK(line[5] == Vec3d(4, 1, 0));
    }
}

TEST_CASE("lines are cut at a stated length, or go on straight from their start to their end") {
    for (const auto& line : moving_lines(rising(5), {0.5, 2.25, 0})) {
        CHECK(line.front() == Vec3d(0));
        CHECK((line.back() - Vec3d(2.25, 0, 0)).length() < 1e-12);
    }
    auto bent = rising(5);
    for (auto& line : bent)
        if (line.points.size() == 6) line.points.back() = Vec3d(4, 3, 0);
    for (const auto& line : moving_lines(bent, {1, 12, 0})) {
        CHECK(line.size() == 13);
        CHECK((line[7] - Vec3d(4, 3, 0)).length() < 1e-12);
        CHECK((line[12] - Vec3d(8, 6, 0)).length() < 1e-12);
    }
    CHECK(failure_of([] {
              moving_lines(rising(5), {1e-3, 2e3, 0});
          }) ==
          "a rig of the length 2000 has 2000001 points that are 0.001 apart: state a larger "
          "'apart' or a smaller 'length'");
}

TEST_CASE("a line is the mean of those of the frames around it, the nearer the more") {
    std::vector<Streakline> lines;
    for (const double y : {0.0, 0.0, 9.0, 0.0, 0.0})
        lines.push_back({{Vec3d(0), Vec3d(0, y, 1)}, lines.size()});
    lines.push_back({});
    const auto at_end = [](const Lines& moved) {
        std::vector<double> out;
        for (const auto& line : moved) out.push_back(line.back().y() / moved[2].back().y());
        return out;
    };
    const auto still = moving_lines(lines, {0.5, 1, 0}), steady = moving_lines(lines, {0.5, 1, 1}),
               steadier = moving_lines(lines, {0.5, 1, 2});
    CHECK(at_end(still) == std::vector<double>{0, 0, 1, 0, 0});
    const std::vector<double> one{0, 0.5, 1, 0.5, 0}, two{1 / 3.0, 2 / 3.0, 1, 2 / 3.0, 1 / 3.0};
    for (std::size_t t = 0; t < lines.size() - 1; ++t) {
        CHECK(at_end(steady)[t] == Approx(one[t]));
        CHECK(at_end(steadier)[t] == Approx(two[t]));
        CHECK(steadier[t].front() == Vec3d(0));
    }
    CHECK(largest_distance(still[1], still[2]) >
          2 * largest_distance(steady[1], steady[2]) - 1e-12);
}

TEST_CASE(
    "a frame in which nothing flows has the line of the nearest frame in which something does") {
    auto lines = rising(5);
    lines[0].points = lines[1].points = {Vec3d(0)};
    lines[0].oldest = 7;
    lines[1].oldest = 8;
    lines[3].points[1] = Vec3d(1, 0.5, 0);
    const auto filled = moving_lines(lines, {1, 3, 0});
    CHECK(filled[0] == filled[2]);
    CHECK(filled[1] == filled[2]);
    CHECK(filled[2] != filled[3]);
    for (auto& line : lines) line.points.resize(1);
    CHECK(moving_lines(lines, {1, 3, 0}).empty());
}

TEST_CASE("a rig.advect that moves waves with the flow, from the seed on, in rigs of one length",
          "[nightly][long]") {
    const Moving moving(
        "{seed: [0, 0, 0], radius: 0.3, count: 32, scale: 0.5, animate: true, length: 8, steady: "
        "0}",
        swaying(two_dozen), two_dozen);
    REQUIRE(moving.rigs.size() == 24);
    for (const auto& rig : moving.rigs) {
        CHECK(rig->points.size() == 33);
        CHECK(rig->points.front().length() < 1e-12);
        CHECK(length_of(rig->points) == Approx(8).epsilon(0.01));
    }
    // Where the points that were added at frame 15 stand in frame 20, as each frame's wind took
    // them.
    double x = 0;
    for (int frame = 15; frame < 20; ++frame) x += 0.5 * std::sin(2 * M_PI * frame / 20);
    const auto& points = moving.rigs[19]->points;
    const auto nearest = std::ranges::min_element(
        points, {}, [&](const Vec3d& point) { return (point - Vec3d(x, 0, 2.5)).length(); });
    CHECK((*nearest - Vec3d(x, 0, 2.5)).length() < 0.13);
    CHECK(x < -1.4);
    REQUIRE(moving.heard.warnings.size() == 1);
    CHECK_THAT(moving.heard.warnings[0],
               Catch::Matches("the rig moves by up to 0\\.[0-9]+ from frame [0-9]+ to frame "
                              "[0-9]+, more than the 0\\.25 between its points, and seams would "
                              "jump with it: state a larger 'steady' than 0"));
}

TEST_CASE(
    "a rig.advect that is steadied moves less than a step from frame to frame, and says nothing",
    "[nightly][long]") {
    const Moving moving(
        "{seed: [0, 0, 0], radius: 0.3, count: 32, scale: 0.5, animate: true, length: 8, steady: "
        "20}",
        swaying(two_dozen), two_dozen);
    CHECK(moving.heard.warnings.empty());
    double most = 0;
    for (std::size_t t = 1; t < moving.rigs.size(); ++t)
        most = std::max(most, largest_distance(moving.rigs[t - 1]->points, moving.rigs[t]->points));
    CHECK(most < 0.25);
    CHECK(most > 0.05);
}

TEST_CASE("a rig.advect counts its scale in world units or in voxels") {
    const std::vector<int> frames{1, 2, 3, 4};
    const std::vector flows(4, uniform({1, 0, 0}));
    const auto end = [&](const std::string& unit) {
        const Moving moving(
            "{seed: [0, 0, 0], radius: 0, count: 1, animate: true, scale: 2, scale_unit: " + unit +
                "}",
            flows, frames);
        return moving.rigs.front()->points.back().x();
    };
    CHECK(end("world") == Approx(8));
    CHECK(end("voxel") == Approx(2));
}

TEST_CASE(
    "a rig.advect that moves needs a flow in one frame at least, and a still one takes no "
    "parameters of a moving one") {
    const std::vector<int> frames{1, 2, 3};
    const auto still = uniform({0, 0, 0});
    const std::string yaml = "{seed: [0, 0, 9], radius: 1, animate: true}";
    CHECK(failure_of([&] {
              Moving(yaml, {still, still, still}, frames);
          }) ==
          "the points stay within 0.25 of the seed, (0, 0, 9): the velocity there is too small, or "
          "'scale' is");
    CHECK(failure_of([&] {
              Moving("{seed: [0, 0, 90], radius: 1, animate: true}", {still, still, still}, frames);
          }) ==
          "no point around the seed, (0, 0, 90), stays where the velocity is active: move 'seed' "
          "into the flow, or take a smaller 'scale'");
    const Moving late(yaml, {still, uniform({0, 0, 1}), still}, frames);
    CHECK(late.rigs[0]->points == late.rigs[1]->points);
    CHECK(NodeBench(rig_advect(), "{seed: [0, 0, 0], radius: 1, steady: 3, length: 2}").faults() ==
          "length: one rig for all frames has no 'length'; set `animate: true`, or leave it out\n"
          "steady: one rig for all frames has no 'steady'; set `animate: true`, or leave it out\n");
    CHECK(
        NodeBench(rig_advect(), "{seed: [0, 0, 0], radius: 1, animate: true, apart: 0, length: 0}")
            .faults() ==
        "length: 'length' must be more than 0\napart: 'apart' must be more than 0 where the rig "
        "moves\n");
}
