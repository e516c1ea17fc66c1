// Measures against named rivals, each line a ratio within this run: machines are noisy, ratios less so.
//
//   build/bench [--large]      --large: the paper's smoke vortex, 322 x 105 x 331 vertices and 84 frames (needs 2 GB)

#include "nodes/catalogue.h"
#include "nodes/io/vdb_file.h"
#include "nodes/lattice/lattice.h"
#include "nodes/remap/remap.h"
#include "nodes/seam/energy_code.h"
#include "nodes/seam/greedy.h"
#include "runtime/run.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <openvdb/tools/GridTransformer.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>

using namespace fluidcarve;

namespace {

/// Median seconds of several calls.
double seconds(int runs, const std::function<void()>& call) {
    std::vector<double> all;
    for (int n = 0; n < runs; ++n) {
        const auto start = std::chrono::steady_clock::now();
        call();
        all.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(all.begin(), all.end());
    return all[all.size() / 2];
}

double with_threads(int threads, const std::function<double()>& measure) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute(measure);
}

void line(const std::string& what, double figure, const std::string& rest) { fmt::print("{:<56} {:>8.2f}   {}\n", what, figure, rest); }

/// `count` seams that wander by one entry, through the middle of a lattice.
Seams wandering(const Lattice& lattice, int frames, int count) {
    Seams out;
    out.shape = lattice.shape;
    out.lattice = lattice.description;
    out.lattice_hash = lattice.hash;
    for (int t = 0; t < frames; ++t) out.frames.push_back(t + 1);
    for (int n = 0; n < count; ++n) {
        Seams::Seam seam;
        for (int t = 0; t < frames; ++t)
            for (int k = 0; k < out.shape[2]; ++k)
                for (int j = 0; j < out.lateral(); ++j) seam.at.push_back(static_cast<std::uint16_t>(out.carved() / 2 - count / 2 + (j / 3 + k / 5 + t) % 2));
        out.seams.push_back(std::move(seam));
    }
    return out;
}

/// A field without empty space, 0 to 2.
FloatGrid::Ptr dense_field(const std::array<int, 3>& shape) {
    auto grid = FloatGrid::create(0);
    grid->denseFill(openvdb::CoordBBox({0, 0, 0}, {shape[0] - 1, shape[1] - 1, shape[2] - 1}), 1.0f, true);
    for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf)
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel) {
            const auto at = voxel.getCoord();
            voxel.setValue(1 + std::sin(0.3f * static_cast<float>(at.x())) * std::cos(0.2f * static_cast<float>(at.y() + at.z())));
        }
    return grid;
}

void bench_remap(const std::string& name, const FloatGrid::ConstPtr& grid) {
    const auto box = grid->evalActiveVoxelBoundingBox();
    const auto size = box.dim();
    const double spacing = grid->voxelSize().x();
    const auto lattice = make_box(grid->indexToWorld(box.min()), {size.x(), size.y(), size.z()}, spacing, {0, 1, 2});
    const auto carve = [&](int count) {
        const auto seams = std::make_shared<const Seams>(wandering(lattice, 1, count));
        return seconds(5, [&] { carve_grid(grid, lattice, CarveMap(lattice, {seams}, 1, std::nullopt), Interpolation::linear); });
    };
    const auto resample = seconds(3, [&] {
        auto out = FloatGrid::create(grid->background());
        auto moved = grid->transform().copy();
        moved->postTranslate(openvdb::Vec3d(0.3 * spacing));
        out->setTransform(moved);
        openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*grid, *out);
    });
    const double twelve = carve(12);
    line(fmt::format("{}: resampleToMatch / remap of 12 seams", name), resample / twelve,
         fmt::format("{:.1f} M voxels/s", static_cast<double>(grid->activeVoxelCount()) / twelve / 1e6));
    line(fmt::format("{}: remap of 40 seams / of 1 seam", name), carve(std::min(40, size.x() / 2)) / carve(1), "");
    const auto scaling = [&](int threads) { return with_threads(threads, [&] { return carve(12); }); };
    line(fmt::format("{}: remap on 1 thread / on 2", name), scaling(1) / scaling(2), "");
}

void bench_greedy(const std::array<int, 3>& shape, std::size_t frames) {
    EnergyVolume energy(shape, Axis::u, frames, ~std::uint64_t{0}, ".");
    for (std::size_t t = 0; t < frames; ++t) {
        auto slab = energy.slab(t);
        std::uint32_t state = static_cast<std::uint32_t>(t) * 7919 + 1;
        for (auto& code : slab) {
            state = state * 1664525 + 1013904223;
            code = encode_energy(0.1f + static_cast<float>(state >> 8) * 0x1p-24f);
        }
    }
    const auto name = fmt::format("{}x{}x{} x {}", shape[0], shape[1], shape[2], frames);
    const auto solve = [&](int threads) {
        return with_threads(threads, [&] { return seconds(1, [&] { greedy_seam(energy, {0, shape[0] - 1}, 0, 16, [](double) {}); }); });
    };
    volatile std::uint64_t sum = 0;
    const double read = seconds(1, [&] {
        std::uint64_t total = 0;
        for (std::size_t t = 0; t < frames; ++t)
            for (const auto code : energy.slab(t)) total += code;
        sum = total;
    });
    const double two = solve(2);
    line(fmt::format("{}: seam.greedy, 16 starts / reading it once", name), two / read, fmt::format("{:.2f} s a seam", two));
    line(fmt::format("{}: seam.greedy on 1 thread / on 2", name), solve(1) / two, "");
}

void bench_pipeline() {
    const auto registry = builtin_registry();
    const Scratch scratch;
    Problems problems;
    const auto document = read_document(
        "pipelines/plume.yaml", {"out=" + (scratch / "out.####.vdb"), "seams=" + (scratch / "seams.vdb"), "sheet=" + (scratch / "sheet.png")}, problems);
    const auto pipeline = build_pipeline(document, registry, problems);
    if (!problems.empty()) throw std::runtime_error(to_text(problems));
    RunRequest request;
    request.options.threads = 2;
    request.options.in_flight = 3;
    request.options.memory = std::uint64_t{1} << 32;
    request.to = "out";
    request.quiet = true;
    const double run = seconds(3, [&] { run_pipeline(pipeline, registry, request, [] { return false; }); });
    const PathPattern in("tests/data/plume/plume.####.vdb");
    const double floor = seconds(3, [&] {
        for (const auto frame : pipeline.frames.frames()) {
            openvdb::io::File file(in.at(frame));
            file.open(false);
            const auto grids = file.getGrids();
            const auto metadata = file.getMetadata();
            file.close();
            openvdb::io::File(scratch / "floor.vdb").write(*grids, *metadata);
        }
    });
    line("plume.yaml without its picture / reading and writing it", run / floor, fmt::format("{:.2f} s for {} frames", run, pipeline.frames.frames().size()));
}

}  // namespace

int main(int argc, char** argv) {
    openvdb::initialize();
    const bool large = argc > 1 && std::strcmp(argv[1], "--large") == 0;
    fmt::print("{:<56} {:>8}\n", "", "ratio");
    bench_pipeline();
    bench_remap("plume density", openvdb::gridConstPtrCast<FloatGrid>(read_vdb_grid("tests/data/plume/plume.0056.vdb", "density")));
    bench_remap("dense 161x52x165", dense_field({161, 52, 165}));
    bench_greedy({161, 52, 165}, 20);
    if (large) bench_greedy({322, 105, 331}, 84);
    return 0;
}
