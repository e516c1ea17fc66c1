#include "carve/solver/pyramid.h"

#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/greedy.h"
#include "carve/solver/search/coarse.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/line_sweeps.h"
#include "carve/solver/search/protection.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace fluidcarve {

namespace {

/// How much work is spent on a seam.
struct Effort {
    std::size_t exact_entries;  ///< energies of at most this many entries are cut as a whole
    double tolerance;           ///< of such cuts of coarse energies, as a share of the least cost
    int passes;  ///< of messages to and fro at the finest level; each coarser one gets twice as
                 ///< many, up to most_passes
    int sweeps;  ///< along all lines of columns, at each level; in rings each is opened elsewhere
};

constexpr Effort normal_effort{std::size_t{1} << 18, 0, 16, 2},
    best_effort{std::size_t{1} << 18, 0, 32, 4};

/// With a field, each cut and sweep takes several times as long, and seams of less energy look no
/// better; nor do slabs.
constexpr Effort reduced_effort{std::size_t{1} << 12, 0.02, 4, 2};

constexpr int passes_of_draft = 2;
/// More passes at coarse levels lead away from the seam of the finest level.
constexpr int most_passes = 32;

/// Entries of a strip on either side of the seam that it was made around.
constexpr int radius = ColumnMessages::most_entries / 2;

const Effort& effort_for(bool reduced, Quality quality) {
    if (quality == Quality::best) return best_effort;
    return reduced ? reduced_effort : normal_effort;
}

bool small(const EnergyVolume& energy, Window window, const Effort& effort) {
    const auto columns = Columns(energy).count();
    return columns == 1 ||
           columns * static_cast<std::size_t>(window.size()) <= effort.exact_entries;
}

}  // namespace

int Pyramid::passes(bool reduced, int level) const {
    const int finest =
        quality_ == Quality::draft ? passes_of_draft : effort_for(reduced, quality_).passes;
    return std::min(finest << std::min(level, 8), most_passes);
}

void Pyramid::refine(StripMessages& messages, int level, bool reduced, bool attracts, int number,
                     std::vector<std::uint16_t>& seam, const std::function<void()>& check) const {
    const auto& strip = messages.strip();
    const auto cut = [&](double tolerance) {
        seam = cut_seam(strip, seam, 1, tolerance, number, check).at;
    };
    // Messages weigh attracted vertices against all other costs; a cut in a narrow band takes
    // them.
    const bool cuts = quality_ == Quality::best || attracts;
    if (!attracts) messages.improve(seam, passes(reduced, level), level > 0, check);
    if (cuts) cut(1e-3);
    const LineSweeps sweep(strip);
    for (int turn = 0; turn < effort_for(reduced, quality_).sweeps; ++turn) {
        check();
        sweep(seam, turn);
    }
    if (cuts) cut(1e-4);
}

Pyramid::Level Pyramid::coarse_to_fine(const EnergyVolume& energy, Window window, int number,
                                       int level, bool reduced, bool attracts,
                                       const std::function<void()>& check) const {
    const Columns columns(energy);
    const auto& effort = effort_for(reduced, quality_);
    if (small(energy, window, effort))
        return {
            cut_seam(energy, Band::whole(columns.count(), window), effort.tolerance, number, check)
                .at,
            std::nullopt};
    Level out;
    {
        const auto coarse = restrict_energy(energy, window, energy.barrier());
        check();
        const auto found = coarse_to_fine(coarse, {0, coarse.width() - 1}, number, level + 1,
                                          reduced, attracts, check);
        out.seam = past_protected(energy, window,
                                  prolong_seam(Columns(coarse), found.seam, columns, window));
        Strip strip(energy, Band::around(out.seam, radius, window), memory_);
        if (found.messages)
            out.messages.emplace(std::move(strip), window, *found.messages, memory_);
        else out.messages.emplace(std::move(strip), memory_);
    }
    refine(*out.messages, level, reduced, attracts, number, out.seam, check);
    return out;
}

Seams::Seam Pyramid::operator()(const EnergyVolume& energy, Window window, int number,
                                const Tick& tick, SeamBounds* bounds) const {
    const auto check = [&] { tick(0); };
    if (in_open_line(energy)) return lines_(energy, window, number, tick);
    const bool reduced = energy.has_field() || energy.slabs();
    if (small(energy, window, effort_for(reduced, quality_)))
        return exact_seam(energy, window, number, check);
    std::vector<std::uint16_t> best;
    bool bounded = false;
    tbb::parallel_invoke(
        [&] {
            best =
                coarse_to_fine(energy, window, number, 0, reduced, energy.attracts(), check).seam;
        },
        [&] {
            bounded = bounds && bounds->find(energy, window, number, [&](double) { check(); });
        });
    auto least = cost_of(energy, best);
    const auto greedy = greedy_seam_within(
        energy, window, number, energy.slabs() ? 1 : starts_, least, [&](double) { check(); },
        bounded ? bounds : nullptr);
    if (const auto cost = !greedy             ? least
                          : energy.attracts() ? cost_of(energy, greedy->at)
                                              : greedy->energy;
        cost < least) {
        best.assign(greedy->at.begin(), greedy->at.end());
        StripMessages messages(Strip(energy, Band::around(best, radius, window), memory_), memory_);
        refine(messages, 0, reduced, energy.attracts(), number, best, check);
        least = cost_of(energy, best);
        if (cost < least) {
            best.assign(greedy->at.begin(), greedy->at.end());
            least = cost;
        }
    }
    const auto sum = energy.attracts() ? energy_of(energy, best) : least;
    return {std::move(best), sum};
}

}  // namespace fluidcarve
