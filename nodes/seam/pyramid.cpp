#include "nodes/seam/pyramid.h"

#include "nodes/seam/cut/cut_seam.h"
#include "nodes/seam/declare_solver.h"
#include "nodes/seam/dynamic.h"
#include "nodes/seam/greedy.h"
#include "nodes/seam/search/coarse.h"
#include "nodes/seam/search/line_sweeps.h"
#include "nodes/seam/search/protection.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>

namespace fluidcarve {

namespace {

/// How much work is spent on a seam.
struct Effort {
    std::size_t exact_entries;  ///< energies of at most this many entries are cut as a whole
    double tolerance;           ///< of such cuts of coarse energies, as a share of the least cost
    std::size_t many_columns;   ///< energies of more columns are not cut: the seam of the coarser energy is close enough
    int sweeps;                 ///< of lines, instead of those cuts
};
constexpr Effort most_effort{std::size_t{1} << 18, 0, std::size_t{1} << 20, 1};
/// With a field, each cut takes several times as long, and seams of less energy look no better.
constexpr Effort effort_with_field{std::size_t{1} << 15, 0.02, std::size_t{1} << 14, 2};

/// Coarse energies of more columns than this are cut block by block if the finest has too many to be cut: they take most of the time there.
constexpr std::size_t few_columns = std::size_t{1} << 14;

/// Energies of more columns are swept once at most: a second sweep took as long as all else, and won less than 0.2 %.
constexpr std::size_t most_columns_swept_again = std::size_t{1} << 18;

const Effort& effort_for(const EnergyVolume& energy, Quality quality) {
    return energy.has_field() && quality != Quality::best ? effort_with_field : most_effort;
}

bool small(const EnergyVolume& energy, Window window, const Effort& effort) {
    const auto columns = Columns(energy).count();
    return columns == 1 || columns * static_cast<std::size_t>(window.size()) <= effort.exact_entries;
}

}  // namespace

void Pyramid::refine(const EnergyVolume& energy, Window window, int number, bool large, std::vector<std::uint16_t>& seam,
                     const std::function<void()>& tick) const {
    // The strip is as wide as all steps below together may move the seam.
    const Strip strip(energy, Band::around(seam, 3, window));
    const auto& effort = effort_for(energy, quality_);
    const auto sweep = [&](int times = 1) {
        LineSweeps sweep_lines(strip);
        for (int turn = 0; turn < 2 * times; ++turn) {
            tick();
            sweep_lines(seam, turn % 2);
        }
    };
    const auto cut = [&](int radius, double tolerance) { seam = cut_seam(strip, seam, radius, tolerance, number, tick).at; };
    switch (quality_) {
        case Quality::draft: return sweep();
        case Quality::normal:
            if (const auto columns = strip.columns().count(); columns > effort.many_columns)
                return sweep(columns > most_columns_swept_again ? 1 : effort.sweeps);
            if (large && strip.columns().count() > few_columns && !strip.steps()) {
                for (const bool shifted : {false, true}) cut_blocks(strip, seam, shifted, 2e-3, number, tick);
                return;
            }
            cut(1, 2e-3);
            sweep();
            return cut(1, 2e-3);
        case Quality::best:
            cut(2, 1e-3);
            sweep();
            return cut(1, 1e-4);
    }
}

std::vector<std::uint16_t> Pyramid::coarse_to_fine(const EnergyVolume& energy, Window window, int number, bool large, const std::function<void()>& tick) const {
    const Columns columns(energy);
    const auto& effort = effort_for(energy, quality_);
    if (small(energy, window, effort)) return cut_seam(energy, Band::whole(columns.count(), window), effort.tolerance, number, tick).at;
    std::vector<std::uint16_t> seam;
    {
        const auto coarse = restrict_energy(energy, window, energy.barrier());
        tick();
        const auto found = coarse_to_fine(coarse, {0, coarse.width() - 1}, number, large, tick);
        seam = past_protected(energy, window, prolong_seam(Columns(coarse), found, columns, window));
    }
    refine(energy, window, number, large, seam, tick);
    return seam;
}

Seams::Seam Pyramid::operator()(const EnergyVolume& energy, Window window, int number, const Tick& tick) const {
    const auto alive = [&] { tick(0); };
    if (in_open_line(energy)) return dynamic_seam(energy, window, number, tick);
    if (small(energy, window, most_effort)) return exact_seam(energy, window, number, alive);
    const bool large = Columns(energy).count() > most_effort.many_columns;
    std::vector<std::uint16_t> best;
    Seams::Seam greedy;
    // Small cuts keep one thread busy: meanwhile the others search greedily.
    tbb::parallel_invoke([&] { best = coarse_to_fine(energy, window, number, large, alive); },
                         [&] { greedy = greedy_seam(energy, window, number, starts_, [&](double) { alive(); }); });
    auto least = cost_of(energy, best);
    const auto cost = energy.attracts() ? cost_of(energy, greedy.at) : greedy.energy;
    if (cost < least) {
        best.assign(greedy.at.begin(), greedy.at.end());
        refine(energy, window, number, large, best, alive);
        least = cost_of(energy, best);
        if (cost < least) {
            best.assign(greedy.at.begin(), greedy.at.end());
            least = cost;
        }
    }
    const auto sum = energy.attracts() ? energy_of(energy, best) : least;
    return {std::move(best), sum};
}

template <>
struct ChoiceNames<Quality> {
    static constexpr std::array names = {std::pair{"draft", Quality::draft}, std::pair{"normal", Quality::normal}, std::pair{"best", Quality::best}};
};

namespace {

struct PyramidNode : SeamNode {
    struct Params : SeamNode::Params {
        Quality quality = Quality::normal;
        int starts = 16;
    };
    void finish(const Params& params, Ports& io, Context& context) { solve(params, io, context, Pyramid(params.quality, params.starts)); }
};

}  // namespace

NodeType seam_pyramid() {
    Declare<PyramidNode> node(
        "seam.pyramid",
        "Finds seams from coarse to fine, by minimum cuts in narrow bands. They are within half a percent of the least energy in real smoke and fire, and "
        "within a few percent in rougher energies. They are exact in images and small volumes, and never worse than those of `seam.greedy`.");
    return declare_solver(node)
        .param("quality", &PyramidNode::Params::quality,
               "How wide the bands are and how often they are cut. `draft` cuts only the coarsest energies and then improves the seam line by line: about 1 % "
               "above the least energy in real smoke and fire, nearly as fast as `seam.greedy`. `normal` cuts finer energies too, up to a million columns "
               "(vertices across the axis, times frames); beyond, it cuts coarser ones block by block, and improves the finest line by line. "
               "`best` cuts all of them.")
        .param("starts", &PyramidNode::Params::starts, Unit::none, between(1, 4096), "Number of greedy searches that compete; the cheapest seam of all wins.")
        .version(2);
}

}  // namespace fluidcarve
