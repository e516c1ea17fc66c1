#include "carve/solver/greedy.h"

#include "carve/solver/greedy_guide.h"
#include "carve/solver/greedy_sweep.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/protection.h"
#include "carve/solver/search/strip.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

using Entry = std::uint16_t;

/// Largest number of seams that race at once: their steps take a quarter of a byte per seam in
/// every column.
constexpr std::size_t group = 64;

std::vector<Entry> spread(Window window, int starts) {
    const int count = std::min(starts, window.size());
    std::vector<Entry> out;
    for (int s = 0; s < count; ++s)
        out.push_back(static_cast<Entry>(
            window.first + (2 * s + 1) * static_cast<std::int64_t>(window.size()) / (2 * count)));
    return out;
}

/// Races seams in as many sweeps as there are threads.
/// @param limit  as for Sweep::run()
/// @return the cheapest seam, of equals the first; its energy is its cost. None, if each costs
///   more.
template <class Cell, class Values>
std::optional<Seams::Seam> race(const EnergyVolume& energy, Window window, int number,
                                std::span<const Entry> starts, const GuideTable& guide,
                                const CostLimit& limit, const Tick& tick) {
    const auto threads = std::min<std::size_t>(
        static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()), starts.size());
    // Seams with neighbouring starts read the same memory. But bounds also end most of them
    // together: then each sweep gets seams from all over the window.
    std::vector<std::vector<Entry>> shares(threads);
    for (std::size_t n = 0; n < starts.size(); ++n)
        shares[limit.bounds ? n % threads : n * threads / starts.size()].push_back(starts[n]);
    std::vector<std::optional<Sweep<Cell, Values>>> sweeps(threads);
    tbb::parallel_for(std::size_t{0}, threads, [&](std::size_t n) {
        sweeps[n].emplace(energy, window, number, shares[n], guide);
        if (!sweeps[n]->run(limit, tick)) sweeps[n].reset();
    });
    struct Best {
        double sum;
        Entry start;
        std::size_t sweep, seam;
    };
    std::optional<Best> best;
    for (std::size_t n = 0; n < threads; ++n)
        for (std::size_t s = 0; sweeps[n] && s < shares[n].size(); ++s) {
            const Best other{sweeps[n]->sums()[s], shares[n][s], n, s};
            if (!best || std::tie(other.sum, other.start) < std::tie(best->sum, best->start))
                best = other;
        }
    if (!best) return std::nullopt;
    return Seams::Seam{sweeps[best->sweep]->entries(best->seam), best->sum};
}

/// Arguments of a search.
struct Search {
    const EnergyVolume& energy;
    Window window;
    int number, starts;
    Guide guide;
};

template <class Cell, class Values>
std::optional<Seams::Seam> find(const Search& search, const CostLimit& limit, const Tick& tick) {
    const auto& energy = search.energy;
    const bool guided = energy.shape().closed && search.guide == Guide::gaussian;
    const auto table = guided ? gaussians(energy.slices(), mean_energy<Cell>(energy, search.window))
                              : GuideTable();
    const auto entries = spread(search.window, search.starts);
    const auto groups = (entries.size() + group - 1) / group;
    std::optional<Seams::Seam> best;
    for (std::size_t n = 0; n < groups; ++n) {
        const auto some = std::span(entries).subspan(n * group).first(
            std::min(group, entries.size() - n * group));
        auto seam = race<Cell, Values>(
            energy, search.window, search.number, some, table, limit, [&](double fraction) {
                tick((static_cast<double>(n) + fraction) / static_cast<double>(groups));
            });
        if (seam && (!best || seam->energy < best->energy)) best = std::move(seam);
    }
    // The search adds the costs of steps as floats: compute the energy anew.
    if (best && energy.steps()) best->energy = energy_of(energy, best->at);
    return best;
}

template <class Cell>
Seams::Seam find_marked(const Search& search, const Tick& tick) {
    const auto seam = *find<Cell, Marked>(search, {}, tick);
    auto at = past_protected(search.energy, search.window, {seam.at.begin(), seam.at.end()});
    const auto sum = energy_of(search.energy, at);
    return {std::move(at), sum};
}

}  // namespace

Seams::Seam greedy_seam(const EnergyVolume& energy, Window window, int number, int starts,
                        const Tick& tick, Guide guide) {
    const Search search{energy, window, number, starts, guide};
    if (energy.protects() || energy.attracts())
        return energy.summed() ? find_marked<float>(search, tick)
                               : find_marked<Entry>(search, tick);
    return energy.summed() ? *find<float, Unmarked>(search, {}, tick)
                           : *find<Entry, Unmarked>(search, {}, tick);
}

std::optional<Seams::Seam> greedy_seam_within(const EnergyVolume& energy, Window window, int number,
                                              int starts, double most, const Tick& tick,
                                              const SeamBounds* bounds) {
    const Search search{energy, window, number, starts, Guide::cone};
    // Attracted vertices make a seam cheaper again.
    if (energy.summed() || energy.protects() || energy.attracts())
        return greedy_seam(energy, window, number, starts, tick);
    return find<Entry, Unmarked>(search, {most, bounds}, tick);
}

}  // namespace fluidcarve
