#pragma once

#include "carve/simd/wide.h"
#include "carve/solver/costs/lanes.h"
#include "carve/solver/greedy_guide.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/ranked_costs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The limit on the cost of seams.
struct CostLimit {
    double cost = std::numeric_limits<double>::infinity();
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
    using Entry = std::uint16_t;

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
          ring_(!energy.shape().closed ? Ring::open
                : guide.empty()        ? Ring::cone
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
    bool run(const CostLimit& limit, const Tick& tick) {
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
    enum class Ring { open, cone, gaussian };
    /// The cost of a seam that was given up.
    static constexpr auto endless = std::numeric_limits<double>::infinity();
    /// Columns that are prefetched ahead. A seam drifts by at most an entry per column, so its
    /// cache line is known by then.
    static constexpr std::size_t ahead = 12;

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
                    pass_any_column(surroundings(column, now, before, {lateral, k, t}), k, out,
                                    steps);
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

    /// A column and what was visited before it, as pass_any_column() needs it for all seams.
    struct Surroundings {
        const Cell* cells;
        const FieldRun* field;           ///< of the column; null: none
        std::array<Passed, 5> passed{};  ///< neighbours, then columns with which it closes a ring
        std::size_t count = 0;           ///< of `passed`
        std::size_t neighbours = 0;      ///< of `passed`
        /// The entries where rings began, and the largest distance allowed from them.
        std::array<std::pair<const Entry*, int>, 2> reaches{};
        std::size_t starts = 0;  ///< of `reaches`
        bool home = false;       ///< whether the first of them is of slice 0
        bool by_lanes = false;   ///< whether costs are computed for four entries at once
        /// Fields of the columns that come later; null: none.
        std::array<const FieldRun*, 2> next{};
    };

    /// @param now, before  entries in this frame and in the one before, `[column][seam]`
    Surroundings surroundings(const Cell* cells, const Entry* now, const Entry* before,
                              const Columns::Place& at) const {
        const auto seams = starts_.size(), frame_columns = columns_.per_frame(),
                   first_column = at.t * frame_columns;
        const auto c = columns_.at(at.lateral, at.slice, at.t);
        const auto entries_of = [&](std::size_t other) {
            return other < first_column ? before + (other + frame_columns - first_column) * seams
                                        : now + (other - first_column) * seams;
        };
        Surroundings out{.cells = cells, .field = step_costs_.field(c)};
        const auto pass = [&](std::size_t other, bool in_time) {
            out.passed[out.count++] = {entries_of(other), step_costs_.field(other), in_time};
        };
        const auto neighbours = columns_.neighbours(c, at);
        for (std::size_t d = 0; d < neighbours.size(); d += 2)
            if (neighbours[d] < c) pass(neighbours[d], d == 4);
        out.neighbours = out.count;
        const auto stay_near = [&](std::size_t start, std::size_t place, std::size_t size) {
            if (place + 1 == size) pass(start, false);
            out.reaches[out.starts++] = {entries_of(start), static_cast<int>(size - place)};
        };
        out.home = ring_ != Ring::open && at.slice > 0;
        if (out.home) stay_near(columns_.at(at.lateral, 0, at.t), at.slice, columns_.slices());
        if (columns_.ring(0) && at.lateral > 0)
            stay_near(c - at.lateral, at.lateral, columns_.laterals());
        out.by_lanes = out.field && energy_.stride() >= static_cast<std::size_t>(lane_count);
        const auto field_ahead = [&](std::size_t of) {
            return out.field && of + ahead < columns_.count() ? step_costs_.field(of + ahead)
                                                              : nullptr;
        };
        out.next = {field_ahead(c), at.t > 0 ? field_ahead(c - frame_columns) : nullptr};
        return out;
    }

    /// The entries that the columns before allow a seam.
    FLUIDCARVE_INLINE std::pair<int, int> allowed(const Surroundings& around, std::size_t s) const {
        int low = static_cast<int>(first_), high = static_cast<int>(last_);
        for (std::size_t n = 0; n < around.neighbours; ++n) {
            const int entry = around.passed[n].entries[s];
            low = std::max(low, entry - 1);
            high = std::min(high, entry + 1);
        }
        for (std::size_t n = 0; n < around.starts; ++n) {
            low = std::max(low, around.reaches[n].first[s] - around.reaches[n].second);
            high = std::min(high, around.reaches[n].first[s] + around.reaches[n].second);
        }
        return {low, high};
    }

    /// What a seam pays at each of the entries `low` to `high`, of which there are at most 3.
    /// @param base  set to the entry of the first cost
    FLUIDCARVE_INLINE Lanes costs_of(const Surroundings& around, std::size_t s, int low, int high,
                                     int& base) const {
        base = low;
        Lanes out{};
        if (!around.by_lanes) {
            for (int entry = low; entry <= high; ++entry) {
                float cost = values_.cost(around.cells[entry]);
                for (std::size_t n = 0; n < around.count; ++n)
                    cost += step_costs_(around.field, entry, around.passed[n].field,
                                        around.passed[n].entries[s], around.passed[n].in_time);
                out[entry - base] = cost;
            }
            return out;
        }
        base = std::min(low, static_cast<int>(energy_.stride()) - lane_count);
        out = costs_from(around.cells + base);
        for (std::size_t n = 0; n < around.count; ++n)
            add_steps(around.passed[n], *around.field, base, s, out);
        // What the next columns read: the seam drifts by at most an entry per column.
        __builtin_prefetch(around.cells + ahead * energy_.stride() + low);
        for (const auto* const run : around.next)
            if (run) __builtin_prefetch(run->codes + (low - run->first));
        return out;
    }

    /// The same in general: steps may cost something, and rows may close.
    /// @param out  entries in the column, `[seam]`
    void pass_any_column(const Surroundings& around, std::size_t k, Entry* out,
                         std::uint8_t* steps) {
        for_running([&](std::size_t s) FLUIDCARVE_INLINED {
            const auto [low, high] = allowed(around, s);
            const int nearest = around.passed[0].entries[s],
                      from = around.home ? around.reaches[0].first[s] : 0;
            const auto stay = static_cast<unsigned>(std::clamp(nearest, low, high));
            int base = 0;
            const auto costs = costs_of(around, s, low, high, base);
            auto best = ~std::uint64_t{0};
            float least = 0;
            for (int entry = low; entry <= high; ++entry) {
                const float cost = costs[entry - base];
                const float guided =
                    ring_ == Ring::gaussian && around.home
                        ? cost + guide_[k][static_cast<std::size_t>(std::abs(entry - from))]
                        : cost;
                const auto key = key_of(values_.rank(guided), static_cast<unsigned>(entry), stay);
                if (key >= best) continue;
                best = key;
                least = cost;
            }
            out[s] = static_cast<Entry>(best);
            steps[s / 4] =
                static_cast<std::uint8_t>(steps[s / 4] | (out[s] - nearest + 1) << (2 * (s % 4)));
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

}  // namespace fluidcarve
