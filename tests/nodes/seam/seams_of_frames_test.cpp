#include "nodes/seam.h"
#include "tests/support/seams_through.h"
#include "tests/support/solver_bench.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

// `axis: t` of the solver nodes.

namespace {

using Frames = std::vector<FloatGrid::Ptr>;

CoordBBox cells(int i, int j, int k) { return {Coord(0), Coord(i - 1, j - 1, k - 1)}; }

/// Quarters, so that means are exact in 16 bits.
Frames noise(std::mt19937& random, const CoordBBox& voxels, std::size_t frames) {
    Frames out;
    for (std::size_t t = 0; t < frames; ++t)
        out.push_back(energy_grid(
            voxels, [&](const Coord&) { return static_cast<float>(1 + random() % 255) / 4; }));
    return out;
}

/// The same with time along x: frame `i` of it holds what the frames have at `i`.
Frames in_turn(const Frames& from, const CoordBBox& voxels) {
    Frames out;
    for (int i = 0; from.size() > 0 && i <= voxels.max().x(); ++i)
        out.push_back(energy_grid(
            cells(static_cast<int>(from.size()), voxels.max().y() + 1, voxels.max().z() + 1),
            [&](const Coord& at) {
                return from[static_cast<std::size_t>(at.x())]->tree().getValue(
                    Coord(i, at.y(), at.z()));
            }));
    return out;
}

Grids field_of(const Frames& field) {
    if (field.empty()) return {};
    return {{"field", {field.begin(), field.end()}}};
}

/// Requires that seams of frames are those along u of the turned sequence.
void require_alike(NodeType solver, const std::string& in_time, const std::string& along_u,
                   const CoordBBox& voxels, std::size_t frames, bool with_field) {
    CAPTURE(in_time, voxels, frames, with_field);
    std::mt19937 random(7);
    const auto energy = noise(random, voxels, frames),
               field = with_field ? noise(random, voxels, frames) : Frames();
    const std::array<int, 3> shape{voxels.dim().x(), voxels.dim().y(), voxels.dim().z()};
    const auto found = test::solve(solver, "{axis: t, " + in_time + "}", energy, {test::box(shape)},
                                   field_of(field), frames);
    const auto wanted =
        test::solve(std::move(solver), "{" + along_u + "}", in_turn(energy, voxels),
                    {test::box({static_cast<int>(frames), shape[1], shape[2]})},
                    field_of(in_turn(field, voxels)), static_cast<std::size_t>(shape[0]));
    const auto &seams = *found.seams, &others = *wanted.seams;
    CHECK(seams.axis == Axis::t);
    CHECK(seams.shape == shape);
    CHECK(seams.frames.size() == frames);
    CHECK(seams.kind == others.kind);
    CHECK(seams.thickness == others.thickness);
    CHECK(seams.window.has_value() == others.window.has_value());
    REQUIRE(seams.seams.size() == others.seams.size());
    REQUIRE(seams.pairs.size() == others.pairs.size());
    for (std::size_t n = 0; n < seams.seams.size(); ++n) {
        CHECK(seams.seams[n].at == others.seams[n].at);
        CHECK(seams.seams[n].energy == others.seams[n].energy);
        CHECK(seams.seams[n].lower_bound == others.seams[n].lower_bound);
    }
    for (std::size_t n = 0; n < seams.pairs.size(); ++n)
        CHECK(seams.pairs[n].at == others.pairs[n].at);
}

std::string faults_in_time(const std::string& params, std::size_t after = 0) {
    return NodeBench(seam_pyramid(), "{axis: t, count: -1" + params + "}", {{"after", after}})
        .faults();
}

}  // namespace

TEST_CASE(
    "seams of frames are those along u of the sequence with time and u exchanged, for all "
    "solvers") {
    for (const std::string common : {"count: -2", "count: 2", "count: -1, window: [1, 3]",
                                     "count: -1, window: [0, 2], pair_window: [3, 5]"}) {
        for (const auto& solver : {seam_pyramid(), seam_greedy(), seam_graph_cut()})
            require_alike(solver, common, common, cells(3, 4, 2), 6, false);
        require_alike(seam_dynamic(), common, common, cells(1, 5, 1), 6, false);
    }
    // Steps in space alone.
    require_alike(seam_pyramid(), "count: -2, rigidity: 3",
                  "count: -2, rigidity: 3, rigidity_time: 3", cells(3, 4, 2), 6, false);
    require_alike(seam_graph_cut(), "count: 2, rigidity: 3",
                  "count: 2, rigidity: 3, rigidity_time: 3", cells(3, 3, 2), 5, false);
}

TEST_CASE(
    "seams of frames pay for the edges in time that they leave, and keep the first and the "
    "last frame") {
    for (const auto& solver : {seam_pyramid(), seam_greedy(), seam_graph_cut()})
        require_alike(solver, "count: -2",
                      "count: -2, rigidity: 2, rigidity_time: 2, window: [1, 5]", cells(4, 4, 3), 7,
                      true);
    require_alike(seam_pyramid(), "count: 2",
                  "count: 2, rigidity: 2, rigidity_time: 2, window: [1, 5]", cells(4, 4, 3), 7,
                  true);
    // Slabs.
    require_alike(seam_pyramid(), "count: -4, thickness: 2",
                  "count: -4, thickness: 2, window: [1, 10]", cells(6, 5, 4), 12, true);
}

TEST_CASE("the pause in a motion is what leaves first") {
    // A ramp that moves by one voxel per frame, but for frames 4 to 7.
    const std::vector<int> at{0, 1, 2, 3, 4, 4, 4, 4, 5, 6, 7};
    Frames field, energy;
    for (const int step : at) {
        field.push_back(energy_grid(cells(5, 4, 3), [&](const Coord& voxel) {
            return static_cast<float>((3 * (voxel.x() + step) + 5 * voxel.y()) % 11 + 1);
        }));
        energy.push_back(energy_grid(cells(5, 4, 3), [](const Coord&) { return 1.0f; }));
    }
    const auto found = test::solve(seam_pyramid(), "{axis: t, count: -3, spread: 3}", energy,
                                   {test::box({5, 4, 3})}, field_of(field), at.size());
    REQUIRE(found.seams->seams.size() == 3);
    for (const auto& seam : found.seams->seams)
        for (const int entry : seam.at) {
            CHECK(entry >= 4);
            CHECK(entry <= 7);
        }
}

TEST_CASE("each of two things apart loses its own pause") {
    constexpr int apart = 12, size = 3;
    // Both move by a voxel per frame, but for three frames: 2 to 4 and 8 to 10.
    const auto place = [](int frame, int pause) { return frame - std::clamp(frame - pause, 0, 2); };
    Frames field, energy;
    for (int frame = 0; frame < 14; ++frame) {
        field.push_back(energy_grid(cells(2 * size + apart, 4, 3), [&](const Coord& voxel) {
            const bool first = voxel.x() < size, second = voxel.x() >= size + apart;
            const int moved = place(frame, first ? 2 : 8);
            return first || second ? static_cast<float>((5 * voxel.y() + 3 * moved) % 11 + 1) : 0;
        }));
        energy.push_back(
            energy_grid(cells(2 * size + apart, 4, 3), [](const Coord&) { return 1.0f; }));
    }
    const auto found =
        test::solve(seam_pyramid(), "{axis: t, count: -2}", energy,
                    {test::box({2 * size + apart, 4, 3})}, field_of(field), field.size());
    REQUIRE(found.seams->seams.size() == 2);
    const auto per_layer = found.seams->columns() / (2 * size + apart);
    for (const auto& seam : found.seams->seams)
        for (std::size_t n = 0; n < size * per_layer; ++n) {
            const int first = seam.at[n], second = seam.at[seam.at.size() - 1 - n];
            CHECK(first >= 2);
            CHECK(first <= 4);
            // It counts what the first seam left.
            CHECK(second >= 7);
            CHECK(second <= 10);
        }
}

TEST_CASE("what seams of frames can't do is refused, with a remedy") {
    CHECK(faults_in_time("") == "");
    CHECK_THAT(faults_in_time(", static: true"),
               Catch::Contains("static: parameter 'static' is not for `axis: t`, where each place "
                               "loses or gains other frames: leave it out"));
    CHECK_THAT(faults_in_time(", anchor: high"), Catch::Contains("anchor: "));
    CHECK_THAT(faults_in_time(", rigidity_time: 1"),
               Catch::Contains("steps are from place to place, and cost `rigidity`"));
    CHECK_THAT(faults_in_time(", finest: 2"), Catch::Contains("seams are found at full size"));
    CHECK_THAT(faults_in_time(", best_effort: true"),
               Catch::Contains("the number of frames must be known before the run"));
    CHECK_THAT(
        faults_in_time("", 1),
        Catch::Contains(
            "carve frames by one remap.grids, and carve its result in space by other nodes"));
    std::mt19937 random(1);
    const auto failure = [&](const std::string& yaml) {
        return failure_of([&] {
            test::solve(seam_pyramid(), yaml, noise(random, cells(2, 2, 1), 4),
                        {test::box({2, 2, 1})}, {}, 4);
        });
    };
    CHECK(failure("{axis: t, count: -4}") == "count -4 removes all 4 frames; at most 3 can go");
    CHECK(failure("{axis: t, count: -1, window: [1, 4]}") ==
          "window [1, 4] leaves the sequence, which has 4 frames: 0 to 3");
    CHECK_THAT(failure("{axis: t, count: -3, window: [1, 2]}"),
               Catch::Contains("window [1, 2] has room to remove 2"));
}

TEST_CASE("a place where all frames are protected is told") {
    std::mt19937 random(3);
    const Grids masks{{"protect", {mask_grid({Coord(1, 0, 0)})}}};
    CHECK_THAT(
        failure_of([&] {
            test::solve(seam_pyramid(), "{axis: t, count: -1}", noise(random, cells(2, 2, 1), 4),
                        {test::box({2, 2, 1})}, masks, 4);
        }),
        Catch::Contains("no seam is possible in window [0, 3]: all frames of vertex (1, 0, 0), at "
                        "(1, 0, 0), are protected; ask for fewer"));
}
