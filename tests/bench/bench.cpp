// Measures against named rivals, each line a ratio within this run: machines are noisy, ratios less
// so.
//
//   build/bench [--large] [--keep] [--only PART]... [VORTEX_FOLDER]
//
// --large: the paper's smoke vortex, 322 x 105 x 331 vertices and 84 frames (needs 3 GB), and smoke
// in 1000 x 600 x 600 voxels --keep: write the figures to pipelines/gallery/bench.md
// --only: pipeline, memory, cache, energy, remap, points, vortex, cut, lqr, greedy, pyramid,
// sparse, warp or page the folder: another sequence like tests/data/vortex

#include "carve/energy/combine.h"
#include "carve/energy/gradient.h"
#include "carve/energy/vorticity.h"
#include "carve/lattice/build.h"
#include "carve/remap/grid.h"
#include "carve/rig/circle.h"
#include "carve/sdf/balls.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/sample.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "formats/points_file/points_file.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/catalogue.h"
#include "nodes/params/rim.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/cache.h"
#include "tests/bench/copying.h"
#include "tests/bench/cut.h"
#include "tests/bench/lqr.h"
#include "tests/bench/measure.h"
#include "tests/bench/page.h"
#include "tests/bench/sparse.h"
#include "tests/bench/vortex.h"
#include "tests/bench/warp.h"
#include "tests/support/balls_by_openvdb.h"
#include "tests/support/program.h"
#include "tests/support/seams_through.h"
#include "tests/support/synthetic_energy.h"
#include "tests/support/vdb_grid.h"

#include <openvdb/tools/GridTransformer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

using namespace fluidcarve;
using openvdb::Vec3d;

namespace {

/// Entries between `count` seams that are spread evenly over a lattice.
int evenly(const Lattice& lattice, int count) {
    return std::max(1, lattice.shape[0] * 3 / 4 / count);
}

/// `count` seams that wander by one entry, so many entries apart, from an eighth of the way into a
/// lattice on: whatever their number, as many voxels move.
Seams wandering(const Lattice& lattice, int count, int apart) {
    auto out = test::no_seams(lattice);
    for (int n = 0; n < count; ++n) {
        // In the space that the seams before leave.
        const int first = out.before() / 8 + n * (apart - 1);
        std::vector<std::uint16_t> at;
        for (int k = 0; k < out.shape[2]; ++k)
            for (int j = 0; j < out.laterals(); ++j)
                at.push_back(static_cast<std::uint16_t>(first + (j / 3 + k / 5) % 2));
        out.seams.push_back({std::move(at), 0});
    }
    return out;
}

/// A field without empty space, 0 to 2.
FloatGrid::Ptr dense_field(const std::array<int, 3>& shape) {
    auto grid = FloatGrid::create(0);
    grid->denseFill(openvdb::CoordBBox({0, 0, 0}, {shape[0] - 1, shape[1] - 1, shape[2] - 1}), 1.0f,
                    true);
    for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf)
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel) {
            const auto at = voxel.getCoord();
            voxel.setValue(1 + std::sin(0.3f * static_cast<float>(at.x())) *
                                   std::cos(0.2f * static_cast<float>(at.y() + at.z())));
        }
    return grid;
}

Lattice lattice_around(const FloatGrid& grid) {
    const auto box = grid.evalActiveVoxelBoundingBox();
    const auto size = box.dim();
    return make_box(grid.indexToWorld(box.min()), {size.x(), size.y(), size.z()},
                    grid.voxelSize().x(), {0, 1, 2});
}

/// A closed lattice around the middle of a field of the shape, about its y axis, that holds most of
/// it.
Lattice ring_in(const std::array<int, 3>& shape) {
    const Vec3d middle(0.5 * (shape[0] - 1), 0.5 * (shape[1] - 1), 0.5 * (shape[2] - 1));
    const double radius = 0.31 * shape[0];
    LatticeSpec spec;
    spec.spacing = 1;
    spec.u = {-0.6 * radius, 0.6 * radius};
    spec.v = {-middle.y(), middle.y()};
    return build_lattice(circle_rig(middle, Vec3d(0, 1, 0), {radius, radius}, 0), spec).lattice;
}

void bench_remap(const std::string& name, const FloatGrid::ConstPtr& grid, const Lattice& lattice) {
    const auto carve_apart = [&](int count, int apart) {
        const auto seams = std::make_shared<const Seams>(wandering(lattice, count, apart));
        const CarveMap map(lattice, {seams}, 1, std::nullopt);
        return seconds(9, [&] { carve_grid(grid, lattice, map, Interpolation::linear); });
    };
    const auto carve = [&](int count) { return carve_apart(count, evenly(lattice, count)); };
    const auto resample = seconds(3, [&] {
        auto out = FloatGrid::create(grid->background());
        auto moved = grid->transform().copy();
        moved->postTranslate(openvdb::Vec3d(0.3 * grid->voxelSize().x()));
        out->setTransform(moved);
        openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*grid, *out);
    });
    const auto rate = [&](const std::string& which, double carved) {
        line(fmt::format("{}: resampleToMatch / remap of 12 seams{}", name, which),
             resample / carved,
             fmt::format("{:.1f} M voxels/s",
                         static_cast<double>(grid->activeVoxelCount()) / carved / 1e6));
    };
    rate("", carve(12));
    rate(", side by side", carve_apart(12, 1));
    const auto with_map = [&](Softness softness) {
        const auto seams =
            std::make_shared<const Seams>(wandering(lattice, 12, evenly(lattice, 12)));
        return seconds(9, [&] {
            carve_grid(grid, lattice,
                       CarveMap(lattice, {seams}, 1, std::nullopt, std::vector{softness}),
                       Interpolation::linear);
        });
    };
    line(fmt::format("{}: remap of 12 seams / the same softly", name),
         with_map({}) / with_map({3, 0}));
    line(fmt::format("{}: remap of {} seams / of 1", name, std::min(40, lattice.shape[0] / 2)),
         carve(std::min(40, lattice.shape[0] / 2)) / carve(1), "", Better::lower);
    scaling(fmt::format("{}: remap of 12 seams", name), [&] { return carve(12); });
}

/// What a frame costs before its seams are found: vorticity, gradient, their sum, and the samples
/// at the lattice's vertices.
void bench_energy(const std::string& name, const std::string& path) {
    const auto density = openvdb::gridConstPtrCast<FloatGrid>(read_vdb_grid(path, "density"));
    const auto velocity = openvdb::gridConstPtrCast<VectorGrid>(read_vdb_grid(path, "velocity"));
    const auto lattice = lattice_around(*density);
    std::vector<std::uint16_t> codes(static_cast<std::size_t>(lattice.shape[0]) *
                                     static_cast<std::size_t>(lattice.shape[1]) *
                                     static_cast<std::size_t>(lattice.shape[2]));
    const auto energy = [&] {
        return seconds(9, [&] {
            const std::vector<EnergyTerm> terms{{vorticity_energy(velocity, 1), 0.5f, {0, 1000}},
                                                {gradient_energy(*density, 1), 0.5f, {0, 10}}};
            sample_energy(*combined_energy(terms), lattice, Axis::u, codes);
        });
    };
    scaling(name + ": energy of a frame", energy);
}

void bench_greedy(const std::array<int, 3>& shape, std::size_t frames) {
    EnergyVolume energy({shape, Axis::u, frames});
    for (std::size_t t = 0; t < frames; ++t) {
        auto codes = energy.codes(t);
        std::uint32_t state = static_cast<std::uint32_t>(t) * 7919 + 1;
        for (auto& code : codes) {
            state = state * 1664525 + 1013904223;
            code = encode_energy(0.1f + static_cast<float>(state >> 8) * 0x1p-24f);
        }
    }
    const auto name = fmt::format("{}x{}x{} x {}", shape[0], shape[1], shape[2], frames);
    const auto solve = [&] {
        return seconds(3, [&] { greedy_seam(energy, {0, shape[0] - 1}, 0, 16, [](double) {}); });
    };
    volatile std::uint64_t sum = 0;
    const double read = seconds(3, [&] {
        std::uint64_t total = 0;
        for (std::size_t t = 0; t < frames; ++t)
            for (const auto code : energy.codes(t)) total += code;
        sum = total;
    });
    const double two = with_threads(2, solve);
    line(fmt::format("{}: seam.greedy, 16 starts / reading it once", name), two / read,
         fmt::format("{:.2f} s a seam", two), Better::lower);
    scaling(fmt::format("{}: seam.greedy, 16 starts", name), solve);
    if (shape[0] == 322)
        line(fmt::format("{}: the paper's 3.7 s on eight cores / seam.greedy", name), 3.7 / two);
}

/// The first seam through synthetic smoke, found again and again by one solver: as in a run, which
/// finds many, it keeps its memory.
void bench_pyramid(const std::array<int, 3>& shape, std::size_t frames) {
    const auto energy = test::SyntheticEnergy(test::Synthetic::smoke, 3)(shape, frames);
    const Window window{0, shape[0] - 1};
    const Tick nobody = [](double) {};
    const Pyramid normal(Quality::normal, 16), best(Quality::best, 16);
    const auto find = [&](const Pyramid& pyramid) {
        return pyramid(energy, window, 0, nobody).energy;
    };
    const auto name = fmt::format("smoke {}x{}x{} x {}", shape[0], shape[1], shape[2], frames);
    double found = 0;
    const double greedy = seconds(3, [&] { greedy_seam(energy, window, 0, 16, nobody); }),
                 pyramid = seconds(3, [&] { found = find(normal); });
    line(name + ": seam.pyramid / seam.greedy", pyramid / greedy,
         fmt::format("{:.2f} s, {:.2f} s", pyramid, greedy), Better::lower);
    line(name + ": energy of seam.pyramid / with quality: best", found / find(best), "",
         Better::lower);
}

/// The frames of tests/data/plume forth and back, as a sequence of `count` in a folder.
PathPattern looped_plume(const Scratch& scratch, int count) {
    for (int frame = 1; frame <= count; ++frame) {
        const int step = (frame - 1) % 10;
        std::filesystem::create_symlink(fmt::format(SOURCE_ROOT "/tests/data/plume/plume.{:04}.vdb",
                                                    step <= 5 ? 51 + step : 61 - step),
                                        scratch / fmt::format("in.{:04}.vdb", frame));
    }
    return PathPattern(scratch / "in.####.vdb");
}

void bench_pipeline() {
    constexpr int frames = 16;
    const Scratch scratch;
    const auto in = looped_plume(scratch, frames);
    const auto registry = builtin_registry();
    const auto file = scratch.write(
        "p.yaml", fmt::format("fluidcarve: 1\nextends: {}/pipelines/plume.yaml\nframes: 1-{}\n",
                              SOURCE_ROOT, frames));
    const auto pipeline = pipeline_of(
        document_in(file, {"sim=" + in.text(), "out=" + (scratch / "out.####.vdb")}), registry);
    auto request = quiet_request();
    request.target.to = "out";
    request.report_path = scratch / "report.json";
    const double run = seconds(3, [&] { run_to_end(pipeline, registry, request); });
    const double floor = seconds_to_copy(in, frames, scratch / "floor.vdb");
    const auto report = nlohmann::json::parse(Scratch::read(request.report_path));
    double work = 0;
    for (const auto& node : report["nodes"]) work += node["wall_s"].get<double>();
    std::string shares;
    for (const auto& [name, node] : report["nodes"].items())
        shares += fmt::format(" {} {:.0f} %", name, 100 * node["wall_s"].get<double>() / work);
    line("plume.yaml, 16 frames, no picture / reading and writing them", run / floor,
         fmt::format("{:.2f} s:{}", run, shares), Better::lower);
}

/// Peak memory of read -> vorticity -> write, as the program reports it.
double peak_memory(int frames) {
    const Scratch scratch;
    const auto in = looped_plume(scratch, frames);
    const auto file = scratch.write(
        "p.yaml", fmt::format("fluidcarve: 1\nframes: 1-{}\nnodes:\n"
                              "  sim:  {{type: vdb.read, path: {}, grids: {{velocity: vector}}}}\n"
                              "  spin: {{type: energy.vorticity, velocity: sim.velocity}}\n"
                              "  out:  {{type: vdb.write, source: spin, path: {}}}\n",
                              frames, in.text(), scratch / "out.####.vdb"));
    const auto ran = fluidcarve_program(
        fmt::format("run -q {} --threads 2 --report {}", file, scratch / "report.json"));
    if (ran.code != 0) throw std::runtime_error(ran.err);
    return nlohmann::json::parse(Scratch::read(scratch / "report.json"))["peak_rss_bytes"]
        .get<double>();
}

void bench_memory() {
    const double few = peak_memory(16), many = peak_memory(160);
    line("read, vorticity, write: peak memory of 160 frames / of 16", many / few,
         fmt::format("{:.1f} MB, {:.1f} MB", many / 1e6, few / 1e6), Better::lower);
}

void bench_points() {
    const auto points =
        read_points(SOURCE_ROOT "/tests/data/river/meander.0037.vdb", "", PointOffset::detect, {});
    auto centres = points.positions();
    const double voxel = points.grid->voxelSize().x();
    for (auto& centre : centres) centre = points.grid->worldToIndex(centre);
    const Balls balls{centres, 1.4, 3};
    const double rival = seconds(5, [&] { test::balls_by_openvdb(balls, voxel); }),
                 ours = seconds(15, [&] { distances_to_balls(balls, voxel); });
    line(fmt::format("river, {} particles: ParticlesToLevelSet / sdf.from_points", centres.size()),
         rival / ours, fmt::format("{:.3f} s, {:.3f} s", rival, ours));
}

}  // namespace

int main(int argc, char** argv) {
    openvdb::initialize();
    bool large = false, keep = false, usage = false;
    std::string vortex = SOURCE_ROOT "/tests/data/vortex";
    std::vector<std::string> wanted;
    for (int n = 1; n < argc; ++n)
        if (std::strcmp(argv[n], "--large") == 0) large = true;
        else if (std::strcmp(argv[n], "--keep") == 0) keep = true;
        else if (std::strcmp(argv[n], "--only") == 0 && n + 1 < argc)
            wanted.emplace_back(argv[++n]);
        else if (argv[n][0] == '-') usage = true;
        else vortex = argv[n];
    const std::string plume = SOURCE_ROOT "/tests/data/plume/plume.0056.vdb";
    const std::vector<std::pair<std::string, std::function<void()>>> parts{
        {"pipeline", bench_pipeline},
        {"memory", bench_memory},
        {"cache", bench_cache},
        {"energy", [&] { bench_energy("plume", plume); }},
        {"remap",
         [&] {
             const auto density =
                 openvdb::gridConstPtrCast<FloatGrid>(read_vdb_grid(plume, "density"));
             bench_remap("plume density", density, lattice_around(*density));
             const auto dense = dense_field({161, 52, 165});
             bench_remap("dense 161x52x165", dense, lattice_around(*dense));
             bench_remap("ring in dense 322x105x331", dense_field({322, 105, 331}),
                         ring_in({322, 105, 331}));
         }},
        {"points", bench_points},
        {"vortex", [&] { bench_vortex(vortex); }},
        {"cut", bench_cut},
        {"lqr", bench_lqr},
        {"greedy",
         [&] {
             bench_greedy({161, 52, 165}, 20);
             if (large) bench_greedy({322, 105, 331}, 84);
         }},
        {"pyramid",
         [&] {
             bench_pyramid({161, 52, 165}, 20);
             if (large) bench_pyramid({322, 105, 331}, 84);
         }},
        {"sparse", [&] { bench_sparse(large); }},
        {"warp", [&] { bench_warp(large); }},
        {"page", bench_page},
    };
    const auto unknown = std::ranges::find_if(wanted, [&](const std::string& name) {
        return std::ranges::none_of(parts, [&](const auto& part) { return part.first == name; });
    });
    if (usage || unknown != wanted.end()) {
        fmt::print("bench [--large] [--keep] [--only PART]... [FOLDER OF A VORTEX]\nparts:");
        for (const auto& part : parts) fmt::print(" {}", part.first);
        fmt::print("\n");
        return unknown != wanted.end() ? 2 : 0;
    }
    fmt::print("{:<80} {:>8}\n", "", "ratio");
    for (const auto& [name, run] : parts)
        if (wanted.empty() || std::ranges::find(wanted, name) != wanted.end()) run();
    const std::string page = SOURCE_ROOT "/pipelines/gallery/bench.md";
    const auto kept = read_kept(page);
    for (const auto& worse : worse_than_kept(kept, figures()))
        fmt::print("worse by more than a tenth: {}\n", worse);
    if (keep) write_kept(page, kept, figures());
    return 0;
}
