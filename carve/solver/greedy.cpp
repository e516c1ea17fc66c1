#include "carve/solver/greedy.h"

#include "carve/simd/wide.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/lanes.h"
#include "carve/solver/greedy_guide.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/protection.h"
#include "carve/solver/search/ranked_costs.h"
#include "carve/solver/search/strip.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

using Entry = std::uint16_t;

/// Columns that are prefetched ahead. A seam drifts by at most an entry per column, so its cache
/// line is known by then.
constexpr std::size_t ahead = 12;

/// Largest number of seams that race at once: their steps take a quarter of a byte per seam in
/// every column.
constexpr std::size_t group = 64;

enum class Ring { open, cone, gaussian };

constexpr auto endless = std::numeric_limits<double>::infinity();

/// The limit on the cost of seams.
struct Limit {
    double cost = endless;
    /// Lower bounds by which seams are given up early; null: none.
    const SeamBounds* bounds = nullptr;
};

/// Seams that advance together through all columns, so that the energy is read once for all of
/// them. Each stores its steps: the difference, -1 to 1, of its entry from that of the nearest
/// column before.
/// @tparam Values  Unmarked or Marked
template <class Cell, class Values>
class Sweep {
public:
    /// @param starts  the entry of each seam in the first column
    /// @param guide   empty: none
    Sweep(const EnergyVolume& energy, Window window, int number, std::span<const Entry> starts,
          const GuideTable& guide)
        : energy_(energy),
          values_(energy),
          first_(static_cast<unsigned>(window.first)),
          last_(static_cast<unsigned>(window.last)),
          below_first_(number % 2 == 0),
          starts_(starts),
          guide_(guide),
          ring_(!energy.closed() ? Ring::open
                : guide.empty()  ? Ring::cone
                                 : Ring::gaussian),
          step_costs_(energy.steps()),
          columns_(energy),
          step_bytes_((starts.size() + 3) / 4),
          entries_(2 * energy.columns_per_frame() * starts.size()),
          steps_(energy.frames() * energy.columns_per_frame() * step_bytes_),
          sums_(starts.size(), 0.0),
          running_(starts.size()) {
        std::iota(running_.begin(), running_.end(), std::size_t{0});
    }

    /// @param limit  seams that cost more are given up; costs must not be below 0
    /// @return whether a seam costs no more
    bool run(const Limit& limit, const Tick& tick) {
        for (std::size_t t = 0; t < energy_.frames(); ++t) {
            tick(static_cast<double>(t) / static_cast<double>(energy_.frames()));
            const auto before = sums_;
            pass_frame(t);
            std::erase_if(running_, [&](std::size_t s) {
                const bool costs_more =
                    sums_[s] > limit.cost ||
                    (limit.bounds && limit.bounds->with({t, before[s], sums_[s], frame(t) + s,
                                                         starts_.size()}) > limit.cost);
                if (costs_more) sums_[s] = endless;
                return costs_more;
            });
            if (running_.empty()) return false;
        }
        return true;
    }

    /// The cost of each seam; endless if it was given up.
    const std::vector<double>& sums() const { return sums_; }

    /// Entries of one seam, `[t][column]`.
    std::vector<Entry> entries(std::size_t seam) const {
        const auto laterals = static_cast<std::size_t>(energy_.laterals()),
                   columns = energy_.columns_per_frame();
        std::vector<Entry> out(energy_.frames() * columns);
        out[0] = starts_[seam];
        for (std::size_t n = 1; n < out.size(); ++n) {
            const auto c = n % columns;
            const auto nearest = c % laterals > 0 ? out[n - 1]
                                 : c >= laterals  ? out[n - laterals]
                                                  : out[n - columns];
            const int step = (steps_[n * step_bytes_ + seam / 4] >> (2 * (seam % 4)) & 3) - 1;
            out[n] = static_cast<Entry>(nearest + step);
        }
        return out;
    }

private:
    /// The seams' entries in slice 0, and the largest distance allowed from them.
    struct Home {
        const Entry* entries;
        unsigned reach;
        const float* guide;
    };

    Entry* frame(std::size_t t) {
        return entries_.data() + t % 2 * energy_.columns_per_frame() * starts_.size();
    }

    void pass_frame(std::size_t t) {
        const auto seams = starts_.size(), laterals = static_cast<std::size_t>(energy_.laterals()),
                   columns = energy_.columns_per_frame();
        const auto slices = static_cast<std::size_t>(energy_.slices());
        const auto* const codes = energy_.cells<Cell>(t);
        Entry* const now = frame(t);
        const Entry* const before = t > 0 ? frame(t - 1) : nullptr;
        std::size_t c = 0;
        for (std::size_t k = 0; k < slices; ++k)
            for (std::size_t lateral = 0; lateral < laterals; ++lateral, ++c) {
                // A neighbour that does not exist is replaced by one that does.
                const Entry* beside = lateral > 0 ? now + (c - 1) * seams : nullptr;
                const Entry* under = k > 0 ? now + (c - laterals) * seams : nullptr;
                const Entry* earlier = before ? before + c * seams : nullptr;
                const Entry* const a = beside ? beside : under ? under : earlier;
                const auto* const column = codes + c * energy_.stride();
                if (!a) {
                    start(column, now);
                    continue;
                }
                const Entry* const b = under ? under : a;
                const Entry* const d = earlier ? earlier : a;
                Entry* const out = now + c * seams;
                auto* const steps = steps_.data() + (t * columns + c) * step_bytes_;
                if (step_costs_ || columns_.ring(0)) {
                    pass_any_column(column, now, before, {lateral, k, t}, steps);
                    continue;
                }
                if (ring_ == Ring::open || k == 0) {
                    pass_column<Ring::open>(column, out, a, b, d, steps, {});
                    continue;
                }
                const Home home{now + lateral * seams, static_cast<unsigned>(slices - k),
                                ring_ == Ring::gaussian ? guide_[k].data() : nullptr};
                if (ring_ == Ring::cone) pass_column<Ring::cone>(column, out, a, b, d, steps, home);
                else pass_column<Ring::gaussian>(column, out, a, b, d, steps, home);
            }
    }

    void start(const Cell* column, Entry* out) {
        for (std::size_t s = 0; s < starts_.size(); ++s) {
            out[s] = starts_[s];
            sums_[s] += values_.cost(column[out[s]]);
        }
    }

    /// Calls `call(seam)` for the seams not given up.
    template <class Call>
    void for_running(const Call& call) const {
        // While all of them run, a counted loop is faster.
        const auto seams = starts_.size();
        if (running_.size() == seams)
            for (std::size_t s = 0; s < seams; ++s) call(s);
        else
            for (const auto s : running_) call(s);
    }

    template <Ring ring>
    void pass_column(const Cell* column, Entry* out, const Entry* a, const Entry* b, const Entry* c,
                     std::uint8_t* steps, const Home& home) {
        for_running([&](std::size_t s) FLUIDCARVE_INLINED {
            // Neighbours differ by at most 2, so they allow 1 to 3 entries.
            const unsigned most = std::max({a[s], b[s], c[s]}),
                           least = std::min({a[s], b[s], c[s]});
            unsigned low = most > first_ ? most - 1 : first_, high = std::min(least + 1, last_);
            unsigned from = 0;
            if constexpr (ring != Ring::open) {
                from = home.entries[s];
                low = std::max(low, from > home.reach ? from - home.reach : 0);
                high = std::min(high, from + home.reach);
            }
            const unsigned stay = std::clamp<unsigned>(a[s], low, high), middle = (low + high) / 2;
            const auto key = [&](unsigned entry) {
                std::uint32_t rank = 0;
                if constexpr (ring == Ring::gaussian)
                    rank = values_.rank(values_.cost(column[entry]) +
                                        home.guide[entry > from ? entry - from : from - entry]);
                else rank = values_.rank(column[entry]);
                return key_of(rank, entry, stay);
            };
            const auto best = std::min({key(low), key(middle), key(high)});
            out[s] = static_cast<Entry>(best);
            steps[s / 4] =
                static_cast<std::uint8_t>(steps[s / 4] | (out[s] - a[s] + 1) << (2 * (s % 4)));
            if constexpr (ring == Ring::gaussian) sums_[s] += values_.cost(column[out[s]]);
            else
                sums_[s] +=
                    Values::template cost_of_rank<Cell>(static_cast<std::uint32_t>(best >> 32));
            __builtin_prefetch(column + ahead * energy_.stride() + out[s]);
        });
    }

    /// A neighbour that was visited before.
    struct Passed {
        const Entry* entries;   ///< of all seams
        const FieldRun* field;  ///< of the column; null: no field
        bool in_time;
    };

    /// Costs of four consecutive entries.
    Lanes costs_from(const Cell* cells) const {
        if constexpr (std::is_same_v<Values, Unmarked> && std::is_same_v<Cell, std::uint16_t>)
            return energy_lanes(cells);
        Lanes out;
        for (int n = 0; n < lane_count; ++n) out[n] = values_.cost(cells[n]);
        return out;
    }
    /// Adds what a seam pays for its step from a neighbour to each of some entries. Of the two
    /// values that a step puts beside each other, one is the column's at the neighbour's entry, the
    /// other the neighbour's at the column's entry (StepCosts).
    /// @param field  of the column
    /// @param base   the first of the entries
    void add_steps(const Passed& passed, const FieldRun& field, int base, std::size_t seam,
                   Lanes& costs) const {
        const int there = passed.entries[seam];
        costs += without(
            step_costs_.lift(passed.in_time, field.value(there), passed.field->values(base)), base,
            there);
    }

    /// The same in general: steps may cost something, and rows may close.
    /// @param now, before  entries in this frame and in the one before, `[column][seam]`
    void pass_any_column(const Cell* column, Entry* now, const Entry* before,
                         const Columns::Place& at, std::uint8_t* steps) {
        const auto seams = starts_.size(), frame_columns = columns_.per_frame(),
                   first_column = at.t * frame_columns;
        const auto c = columns_.at(at.lateral, at.k, at.t);
        const auto around = columns_.around(c, at);
        // The entry where a ring began, and the largest distance allowed from it.
        struct Start {
            bool given;
            std::size_t column;
            int reach;
            bool closes;
        };
        const Start home{ring_ != Ring::open && at.k > 0, columns_.at(at.lateral, 0, at.t),
                         static_cast<int>(columns_.slices() - at.k), at.k + 1 == columns_.slices()};
        const Start row{columns_.ring(0) && at.lateral > 0, c - at.lateral,
                        static_cast<int>(columns_.laterals() - at.lateral),
                        at.lateral + 1 == columns_.laterals()};
        const auto entries_of = [&](std::size_t other) {
            return other < first_column ? before + (other + frame_columns - first_column) * seams
                                        : now + (other - first_column) * seams;
        };
        std::array<Passed, 5> passed;
        std::size_t count = 0;
        const auto pass = [&](std::size_t other, bool in_time) {
            passed[count++] = {entries_of(other), step_costs_.field(other), in_time};
        };
        for (std::size_t d = 0; d < around.size(); d += 2)
            if (around[d] < c) pass(around[d], d == 4);
        const auto before_closing = count;
        for (const auto& start : {home, row})
            if (start.given && start.closes) pass(start.column, false);
        const auto* const field = step_costs_.field(c);
        const bool by_lanes = field && energy_.stride() >= static_cast<std::size_t>(lane_count);
        const auto field_ahead = [&](std::size_t of) {
            return field && of + ahead < columns_.count() ? step_costs_.field(of + ahead) : nullptr;
        };
        const std::array next{field_ahead(c), at.t > 0 ? field_ahead(c - frame_columns) : nullptr};
        std::array<std::pair<const Entry*, int>, 2> reaches;
        std::size_t starts = 0;
        for (const auto& start : {home, row})
            if (start.given) reaches[starts++] = {entries_of(start.column), start.reach};
        for_running([&](std::size_t s) FLUIDCARVE_INLINED {
            int low = static_cast<int>(first_), high = static_cast<int>(last_);
            const int nearest = passed[0].entries[s];
            for (std::size_t n = 0; n < before_closing; ++n) {
                const int entry = passed[n].entries[s];
                low = std::max(low, entry - 1);
                high = std::min(high, entry + 1);
            }
            for (std::size_t n = 0; n < starts; ++n) {
                low = std::max(low, reaches[n].first[s] - reaches[n].second);
                high = std::min(high, reaches[n].first[s] + reaches[n].second);
            }
            const int from = home.given ? reaches[0].first[s] : 0;
            const auto stay = static_cast<unsigned>(std::clamp(nearest, low, high));
            auto best = ~std::uint64_t{0};
            float least = 0;
            const int base =
                by_lanes ? std::min(low, static_cast<int>(energy_.stride()) - lane_count) : low;
            Lanes costs{};
            if (by_lanes) {
                costs = costs_from(column + base);
                for (std::size_t n = 0; n < count; ++n)
                    add_steps(passed[n], *field, base, s, costs);
                // What the next columns read: the seam drifts by at most an entry per column.
                __builtin_prefetch(column + ahead * energy_.stride() + low);
                for (const auto* const run : next)
                    if (run) __builtin_prefetch(run->codes + (low - run->first));
            } else {
                for (int entry = low; entry <= high; ++entry) {
                    float cost = values_.cost(column[entry]);
                    for (std::size_t n = 0; n < count; ++n)
                        cost += step_costs_(field, entry, passed[n].field, passed[n].entries[s],
                                            passed[n].in_time);
                    costs[entry - base] = cost;
                }
            }
            for (int entry = low; entry <= high; ++entry) {
                const float cost = costs[entry - base];
                const float guided =
                    ring_ == Ring::gaussian && home.given
                        ? cost + guide_[at.k][static_cast<std::size_t>(std::abs(entry - from))]
                        : cost;
                const auto key = key_of(values_.rank(guided), static_cast<unsigned>(entry), stay);
                if (key >= best) continue;
                best = key;
                least = cost;
            }
            now[(c - first_column) * seams + s] = static_cast<Entry>(best);
            steps[s / 4] = static_cast<std::uint8_t>(
                steps[s / 4] | (static_cast<int>(static_cast<Entry>(best)) - nearest + 1)
                                   << (2 * (s % 4)));
            sums_[s] += least;
        });
    }

    /// A key that orders candidates by cost, then by ties, then by entry.
    std::uint64_t key_of(std::uint32_t rank, unsigned entry, unsigned stay) const {
        const unsigned tie = entry == stay ? 0 : (entry < stay) == below_first_ ? 1 : 2;
        return std::uint64_t{rank} << 32 | tie << 16 | entry;
    }

    const EnergyVolume& energy_;
    const Values values_;
    const unsigned first_, last_;
    const bool below_first_;
    const std::span<const Entry> starts_;
    const GuideTable& guide_;
    const Ring ring_;
    const StepCosts step_costs_;
    const Columns columns_;
    const std::size_t step_bytes_;
    std::vector<Entry> entries_;
    std::vector<std::uint8_t> steps_;  ///< `[t][column]`, two bits per seam
    std::vector<double> sums_;
    std::vector<std::size_t> running_;  ///< seams that are not given up
};

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
                                const Limit& limit, const Tick& tick) {
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
std::optional<Seams::Seam> find(const Search& search, const Limit& limit, const Tick& tick) {
    const auto& energy = search.energy;
    const bool guided = energy.closed() && search.guide == Guide::gaussian;
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
