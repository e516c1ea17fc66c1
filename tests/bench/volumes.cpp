#include "tests/bench/volumes.h"

#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/bound.h"
#include "nodes/catalogue.h"
#include "nodes/solving/declare_solver.h"
#include "tests/bench/bench_run.h"
#include "tests/support/scratch.h"
#include "tests/support/synthetic_energy.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <numeric>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

const Tick nobody = [](double) {};

/// Seams that are looked for in a row.
constexpr int seams_in_a_row = 4;

/// What a cut of the whole volume may take, in entries, at 40 bytes.
constexpr std::size_t most_entries_cut = std::size_t{1} << 23;

/// What ten passes of the bound may take, in entries, at 12 bytes.
constexpr std::size_t most_entries_passed = std::size_t{1} << 26;

EnergyVolume copy_of(const EnergyVolume& energy) {
    EnergyVolume out(energy.shape());
    for (std::size_t t = 0; t < energy.frames(); ++t)
        std::copy_n(energy.codes(t), out.codes(t).size(), out.codes(t).begin());
    out.find_marks();
    return out;
}

std::optional<EnergyVolume> recorded;

/// In place of a solver: keeps the energy.
struct Record : SeamNode {
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context,
              [](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
                  recorded = copy_of(energy);
                  return greedy_seam(energy, window, number, 1, tick);
              });
    }
};

/// The first and the last frame of `name.####.vdb` in a folder; nothing if there are none.
std::optional<std::pair<int, int>> frames_in(const std::string& folder, const std::string& name) {
    std::optional<std::pair<int, int>> out;
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
        const auto stem = entry.path().stem().string();
        if (entry.path().extension() != ".vdb" || !stem.starts_with(name + ".")) continue;
        const int frame = std::stoi(stem.substr(name.size() + 1));
        out = out ? std::pair(std::min(out->first, frame), std::max(out->second, frame))
                  : std::pair(frame, frame);
    }
    return out;
}

/// The energy that a shipped pipeline's solver gets from a sequence.
std::optional<EnergyVolume> real_energy(const std::string& folder, const std::string& name) {
    const auto frames = frames_in(folder + "/" + name, name);
    if (!frames) return std::nullopt;
    auto registry = builtin_registry();
    Declare<Record> node("seam.record", "Keeps the energy.");
    registry.add(NodeType(declare_solver(node)));
    const Scratch scratch;
    const auto file = scratch.write(
        "p.yaml", fmt::format("fluidcarve: 1\nextends: {}/pipelines/{}.yaml\nframes: {}-{}\n",
                              SOURCE_ROOT, name, frames->first, frames->second));
    const auto document = document_in(
        file,
        {fmt::format("sim={0}/{1}/{1}.####.vdb", std::filesystem::absolute(folder).string(), name),
         "seams.type=seam.record", "count=-1"});
    auto request = quiet_request(std::uint64_t{1} << 33);
    request.target.to = "seams";
    run_to_end(pipeline_of(document, registry), registry, request);
    return std::exchange(recorded, std::nullopt);
}

struct Solver {
    std::string name;
    FindSeam find;
    bool exact = false;
};

std::vector<Solver> solvers() {
    const auto greedy = [](const EnergyVolume& energy, Window window, int number,
                           const Tick& tick) {
        return greedy_seam(energy, window, number, 16, tick);
    };
    const auto cut = [](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
        return exact_seam(energy, window, number, [&] { tick(0); });
    };
    return {{"greedy, 16 starts", greedy},
            {"pyramid, draft", Pyramid(Quality::draft, 16)},
            {"pyramid, normal", Pyramid(Quality::normal, 16)},
            {"pyramid, best", Pyramid(Quality::best, 16)},
            {"graph_cut", cut, true}};
}

class Table {
public:
    explicit Table(const std::string& out) : csv_(out + ".csv"), page_(out + ".md") {
        page_ << fmt::format(
            "# Seams by solver: the paper's table 2\n\nSeconds: of the first seam, and the mean "
            "over {} in a row. Energy: of the first seam. Gap: how "
            "far that is above the least energy, or above a bound of it. A ring's slices are "
            "marked with o.\n\n"
            "| volume | vertices x frames | solver | first s | mean s | / greedy | energy | gap "
            "|\n|---|---|---|--:|--:|--:|--:|--:|\n",
            seams_in_a_row);
        csv_ << "volume,width,laterals,slices,frames,closed,solver,first_s,mean_s,times_greedy,"
                "energy,energy_of_all,reference,gap\n";
        fmt::print("{:<18} {:>19} {:<18} {:>9} {:>9} {:>8} {:>12} {:>12} {:>8}\n", "",
                   "vertices x frames", "", "first s", "mean s", "/ greedy", "energy",
                   fmt::format("all {}", seams_in_a_row), "gap");
    }

    void add(const std::string& name, const EnergyVolume& energy) {
        const auto entries =
            energy.frames() * energy.columns_per_frame() * static_cast<std::size_t>(energy.width());
        const Window window{0, energy.width() - 1};
        std::vector<Row> rows;
        double reference = 0;
        std::string kind;
        for (const auto& solver : solvers()) {
            if (solver.exact && entries > most_entries_cut) continue;
            auto copy = copy_of(energy);
            const auto found = find_seams(copy, {Seams::Kind::remove, window}, seams_in_a_row,
                                          solver.find, nobody);
            Row row{solver.name, found.wall_s.front(),
                    std::accumulate(found.wall_s.begin(), found.wall_s.end(), 0.0) / seams_in_a_row,
                    found.seams.front().energy, 0};
            for (const auto& seam : found.seams) row.all += seam.energy;
            rows.push_back(row);
            if (solver.exact) reference = row.energy;
        }
        if (reference > 0) {
            kind = "exact";
        } else {
            const int passes = entries <= most_entries_passed ? 10 : 2;
            reference = lower_bound(energy, window, passes, nobody);
            kind = fmt::format("bound, {} passes", passes + 1);
        }
        auto size = fmt::format("{}x{}x{}{} x {}", energy.width(), energy.laterals(),
                                energy.slices(), energy.shape().closed ? "o" : "", energy.frames());
        auto title = name;
        for (const auto& row : rows) {
            const double ratio = row.mean / rows.front().mean, gap = row.energy / reference - 1;
            fmt::print(
                "{:<18} {:>19} {:<18} {:>9.3f} {:>9.3f} {:>8.2f} {:>12.2f} {:>12.2f} {:>7.2f}%\n",
                title, size, row.solver, row.first, row.mean, ratio, row.energy, row.all,
                100 * gap);
            csv_ << fmt::format(
                "\"{}\",{},{},{},{},{},\"{}\",{:.4f},{:.4f},{:.3f},{:.6g},{:.6g},\"{}\",{:.6f}\n",
                name, energy.width(), energy.laterals(), energy.slices(), energy.frames(),
                energy.shape().closed ? 1 : 0, row.solver, row.first, row.mean, ratio, row.energy,
                row.all, kind, gap);
            page_ << fmt::format(
                "| {} | {} | {} | {:.3f} | {:.3f} | {:.1f} | {:.1f} | {:.2f} % |\n", title, size,
                row.solver, row.first, row.mean, ratio, row.energy, 100 * gap);
            title = size = "";
        }
        fmt::print("{:<18} {:>19} gap above: {} = {:.2f}\n", "", "", kind, reference);
        page_ << fmt::format("| | | {} | | | | {:.1f} | |\n",
                             kind == "exact" ? "the least energy" : "lower " + kind, reference);
        std::fflush(stdout);
    }
    bool good() const { return csv_.good() && page_.good(); }

private:
    struct Row {
        std::string solver;
        double first, mean, energy, all;
    };
    std::ofstream csv_, page_;
};

}  // namespace

void compare_on_volumes(const std::string& folder, const std::string& out, bool large) {
    Table table(out);
    for (const auto* const name : {"plume", "vortex", "bonfire"})
        if (const auto energy = real_energy(folder, name)) table.add(name, *energy);
    struct Shape {
        std::array<int, 3> size;
        std::size_t frames;
        bool closed;
    };
    std::vector<Shape> shapes{
        {{64, 48, 64}, 10, false}, {{64, 48, 64}, 10, true}, {{161, 52, 165}, 20, false}};
    if (large) shapes.push_back({{322, 105, 331}, 84, false});
    for (const auto& shape : shapes)
        for (const auto& [name, kind] : {std::pair("synthetic smoke", Synthetic::smoke),
                                         std::pair("white noise", Synthetic::noise)})
            table.add(name, SyntheticEnergy(kind, 3)(shape.size, shape.frames, shape.closed));
    if (!table.good())
        throw std::runtime_error(fmt::format("{0}.csv or {0}.md can't be written", out));
    fmt::print("\nwritten: {0}.csv, {0}.md\n", out);
}
