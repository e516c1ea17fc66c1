#include "formats/mesh_file/mesh_file.h"
#include "formats/vdb/vdb_file.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

using namespace fluidcarve;

// `pipelines/torch.yaml`, run by the program and measured: does the flame wave as before, with its
// foot on the handle?

namespace {

constexpr int first_frame = 36, last_frame = 47;

FloatGrid::ConstPtr flame_in(const std::string& path) {
    return openvdb::gridConstPtrCast<FloatGrid>(read_vdb(path).find("flame"));
}

/// The torch, carved by so many seams.
struct CarvedTorch {
    Scratch scratch;
    nlohmann::json report;
    std::vector<FloatGrid::ConstPtr> before, after;

    explicit CarvedTorch(int count, const std::string& pipeline = "torch") {
        auto call =
            fmt::format("run pipelines/{}.yaml -q --progress none --report {} --set count={}",
                        pipeline, scratch / "report.json", count);
        for (const auto& [param, file] :
             {std::pair("out", "fire.####.vdb"), std::pair("moved", "handle.####.obj"),
              std::pair("seams", "seams.vdb"), std::pair("sheet", "sheet.png")})
            call += fmt::format(" --set {}={}", param, scratch / file);
        const auto ran = fluidcarve_program(call);
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        report = nlohmann::json::parse(Scratch::read(scratch / "report.json"));
        for (int frame = first_frame; frame <= last_frame; ++frame) {
            before.push_back(flame_in(fmt::format("{}/torch/torch.{:04}.vdb", TEST_DATA, frame)));
            after.push_back(flame_in(fmt::format("{}.{:04}.vdb", scratch / "fire", frame)));
        }
    }
    Mesh handle(int frame) const {
        return read_mesh(fmt::format("{}.{:04}.obj", scratch / "handle", frame)).mesh;
    }
};

/// The flame at one height, seen along y.
struct Section {
    double middle = 0, width = 0;  ///< centroid and visible width along x, voxels
};

Section section(const FloatGrid& flame, int height) {
    std::map<int, double> brightest;
    double sum = 0, moment = 0;
    for (auto voxel = flame.cbeginValueOn(); voxel; ++voxel) {
        const auto at = voxel.getCoord();
        if (at.z() != height) continue;
        sum += *voxel;
        moment += *voxel * at.x();
        brightest[at.x()] = std::max(brightest[at.x()], static_cast<double>(*voxel));
    }
    return {moment / sum, static_cast<double>(std::ranges::count_if(
                              brightest, [](const auto& column) { return column.second > 0.05; }))};
}

/// Middles of the flame over the frames, less their mean.
std::vector<double> waving(const std::vector<FloatGrid::ConstPtr>& flames, int height) {
    std::vector<double> out;
    double mean = 0;
    for (const auto& flame : flames) out.push_back(section(*flame, height).middle);
    for (const double x : out) mean += x / static_cast<double>(out.size());
    for (double& x : out) x -= mean;
    return out;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double out = 0;
    for (std::size_t n = 0; n < a.size(); ++n) out += a[n] * b[n];
    return out;
}

/// The flame waves in the same rhythm, and nearly as far.
void check_waving(const CarvedTorch& carved) {
    for (const int height : {20, 28}) {
        const auto was = waving(carved.before, height), is = waving(carved.after, height);
        const double rhythm = dot(was, is) / std::sqrt(dot(was, was) * dot(is, is)),
                     reach = std::sqrt(dot(is, is) / dot(was, was));
        INFO("height " << height << ": correlation " << rhythm << ", amplitude " << reach
                       << " of before");
        CHECK(rhythm > 0.9);
        CHECK(reach > 0.5);
        CHECK(reach < 1.6);
    }
}

/// Below the lattice all stays bit for bit: the flame's foot, and the handle.
void check_foot(const CarvedTorch& carved) {
    const auto handle = read_mesh(TEST_DATA "/torch/handle.obj").mesh;
    for (int frame = first_frame; frame <= last_frame; ++frame)
        CHECK(carved.handle(frame).points == handle.points);
    for (std::size_t t = 0; t < carved.before.size(); ++t) {
        std::size_t different = 0, there = 0;
        for (auto voxel = carved.before[t]->cbeginValueOn(); voxel; ++voxel)
            if (voxel.getCoord().z() <= 6) {
                ++there;
                different += carved.after[t]->tree().getValue(voxel.getCoord()) != *voxel;
            }
        CHECK(there > 20);
        CHECK(different == 0);
    }
}

/// By how many voxels the flame is wider, on average over frames and heights.
double widened(const CarvedTorch& carved) {
    double out = 0;
    int count = 0;
    for (std::size_t t = 0; t < carved.before.size(); ++t)
        for (int height = 26; height <= 46; height += 4, ++count)
            out +=
                section(*carved.after[t], height).width - section(*carved.before[t], height).width;
    return out / count;
}

}  // namespace

TEST_CASE(
    "a flame that is made lower or higher along its path keeps its width, its sway and its foot",
    "[nightly][long]") {
    const auto height = [](const FloatGrid& flame) {
        return flame.evalActiveVoxelBoundingBox().max().z();
    };
    for (const int count : {-40, 24}) {
        const CarvedTorch carved(count, "flame_lower");
        check_foot(carved);
        double was = 0, is = 0, wider = 0;
        for (std::size_t t = 0; t < carved.before.size(); ++t) {
            was += height(*carved.before[t]);
            is += height(*carved.after[t]);
            for (const int from : {14, 18})
                wider +=
                    section(*carved.after[t], from).width / section(*carved.before[t], from).width;
        }
        INFO("count " << count << ": height " << is / was << " of before, width "
                      << wider / (2.0 * static_cast<double>(carved.before.size())));
        if (count < 0) CHECK(is < 0.75 * was);
        else CHECK(is > 1.15 * was);
        CHECK(wider / (2.0 * static_cast<double>(carved.before.size())) == Approx(1).margin(0.3));
        // The flame as it was at 28 is now where its path led it.
        const int there = count < 0 ? 20 : 34;
        const auto before = waving(carved.before, 28), after = waving(carved.after, there);
        CHECK(dot(before, after) / std::sqrt(dot(before, before) * dot(after, after)) > 0.6);
    }
}

TEST_CASE("a torch that is made narrower waves as before, with its foot on the handle", "[long]") {
    const CarvedTorch carved(-10);
    CHECK(carved.report["lattices"]["waves"]["folded_cells"] == 0);
    check_waving(carved);
    check_foot(carved);
    const double wider = widened(carved);
    INFO("wider by " << wider << " voxels");
    CHECK(wider < -3.5);
    CHECK(wider > -10);
}

TEST_CASE("a torch that is made wider waves as before, with its foot on the handle",
          "[nightly][long]") {
    const CarvedTorch carved(10);
    CHECK(carved.report["lattices"]["waves"]["folded_cells"] == 0);
    check_waving(carved);
    check_foot(carved);
    const double wider = widened(carved);
    INFO("wider by " << wider << " voxels");
    CHECK(wider > 4);
    CHECK(wider < 12);
}
