#include "nodes/seam/search/strip.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

namespace fluidcarve {

namespace {

constexpr std::size_t grain = 4096;

/// Calls `call(column, its entries)` for the columns from begin to before end.
template <class Cell, class Call>
void for_columns(const EnergyVolume& energy, std::size_t begin, std::size_t end, const Call& call) {
    const auto per_frame = energy.columns_per_frame();
    for (auto c = begin; c < end; ++c) call(c, energy.cells<Cell>(c / per_frame) + c % per_frame * energy.stride());
}

template <class Call>
double sum_over(std::size_t count, const Call& call) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, count, grain), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double sum) { return sum + call(range.begin(), range.end()); }, std::plus<>());
}

}  // namespace

Strip::Strip(const EnergyVolume& energy, const Band& band)
    : columns_(energy),
      band_(band),
      width_(static_cast<std::size_t>(band.columns.front().last - band.columns.front().first + 1)),
      energies_(width_ * columns_.count()),
      steps_(energy.steps()),
      fields_(steps_.has_field() ? (width_ + 2) * columns_.count() : 0),
      protects_(energy.protects()) {
    const auto fill = [&, costs = energy.costs()](auto cell) {
        using Cell = decltype(cell);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns_.count(), grain), [&](const tbb::blocked_range<std::size_t>& range) {
            for_columns<Cell>(energy, range.begin(), range.end(), [&](std::size_t c, const Cell* cells) {
                const auto [first, last] = band_.columns[c];
                for (std::size_t n = 0; n < width_; ++n) energies_[c * width_ + n] = costs(cells[first + n]);
                if (fields_.empty()) return;
                for (int entry = std::max(first - 1, 0); entry <= std::min(last + 1, energy.width() - 1); ++entry)
                    fields_[field_place(c, entry)] = steps_.value(c, entry);
            });
        });
    };
    if (energy.summed()) fill(float{});
    else fill(std::uint16_t{});
}

double Strip::energy(std::span<const std::uint16_t> seam) const {
    return sum_over(seam.size(),
                    [&](std::size_t begin, std::size_t end) {
                        double sum = 0;
                        for (auto c = begin; c < end; ++c) sum += energy(c, seam[c]);
                        return sum;
                    }) +
           cost_of_steps(columns_, steps_, seam);
}

double cost_of_steps(const Columns& columns, const StepCosts& steps, std::span<const std::uint16_t> seam) {
    if (!steps) return 0;
    return sum_over(seam.size(), [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (auto c = begin; c < end; ++c) {
            const auto around = columns.around(c, columns.place(c));
            for (std::size_t d = 1; d < around.size(); d += 2)
                if (around[d] != Columns::none) sum += static_cast<double>(steps(c, seam[c], around[d], seam[around[d]], d / 2 == 2));
        }
        return sum;
    });
}

double cost_of(const EnergyVolume& energy, std::span<const std::uint16_t> seam) {
    const auto add = [&, costs = energy.costs()](auto cell) {
        using Cell = decltype(cell);
        return sum_over(seam.size(), [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for_columns<Cell>(energy, begin, end, [&](std::size_t c, const Cell* cells) { sum += costs(cells[seam[c]]); });
            return sum;
        });
    };
    return (energy.summed() ? add(float{}) : add(std::uint16_t{})) + cost_of_steps(Columns(energy), energy.steps(), seam);
}

double energy_of(const EnergyVolume& energy, std::span<const std::uint16_t> seam) {
    if (!energy.attracts()) return cost_of(energy, seam);
    return sum_over(seam.size(),
                    [&](std::size_t begin, std::size_t end) {
                        double sum = 0;
                        if (energy.summed()) {
                            for (auto c = begin; c < end; ++c) sum += energy.energies()[c * energy.stride() + seam[c]];
                        } else {
                            for_columns<std::uint16_t>(energy, begin, end, [&](std::size_t c, const std::uint16_t* codes) { sum += Costs{}(codes[seam[c]]); });
                        }
                        return sum;
                    }) +
           cost_of_steps(Columns(energy), energy.steps(), seam);
}

double energy_bound(const EnergyVolume& energy, std::span<const std::uint16_t> seam, double cost_bound) {
    if (!energy.attracts()) return cost_bound;
    return std::max(cost_bound + energy_of(energy, seam) - cost_of(energy, seam), 0.0);
}

namespace {

/// What steps cost.
enum class Stepping { free, rigid, field };

/// One line of columns, in which a seam may move while all others stay.
template <Stepping stepping>
class ColumnLine {
public:
    ColumnLine(const Strip& strip, std::vector<std::uint16_t>& seam) : strip_(strip), seam_(seam) {}

    /// Moves the seam in the line to its cheapest entries.
    /// @param first   the line's first column
    /// @param step    from a column to the next
    /// @param length  number of columns
    /// @param along   the dimension of the line: 0 lateral, 1 k, 2 t
    /// @param still   index in the line of the column that stays fixed; -1: none
    void improve(std::size_t first, std::size_t step, std::size_t length, std::size_t along, std::ptrdiff_t still) {
        cells_.resize(length);
        find_beside(first, along);
        // A ring is opened at the fixed column, which then is both ends.
        const bool ring = still >= 0;
        const auto column = [&](std::size_t n) { return first + step * (ring ? (n + static_cast<std::size_t>(still)) % length : n); };
        for (std::size_t n = 0; n < length; ++n) {
            auto& cell = cells_[n];
            const auto c = column(n);
            find_room(cell, c);
            if (ring && n == 0) cell.low = cell.high = seam_[c];
            if (ring && n + 1 == length) {
                const int home = seam_[column(0)];
                cell.low = std::max(cell.low, home - 1);
                cell.high = std::min(cell.high, home + 1);
            }
            for (int entry = cell.low; entry <= cell.high; ++entry) {
                auto& cost = cell.cost[static_cast<std::size_t>(entry - cell.low)];
                cost = strip_.energy(c, entry);
                if constexpr (stepping != Stepping::free)
                    cost += to_beside(c, entry) + (ring && n + 1 == length ? step_cost(c, entry, column(0), seam_[column(0)], false) : 0);
                if (n > 0) come_from(cells_[n - 1], column(n - 1), cell, c, entry, along == 2);
            }
        }
        auto entry = cheapest(cells_.back());
        for (auto n = length; n-- > 0;) {
            seam_[column(n)] = static_cast<std::uint16_t>(entry);
            entry = cells_[n].from[static_cast<std::size_t>(entry - cells_[n].low)];
        }
    }

private:
    /// Those entries of a column that the neighbours beside the line allow: at most three, since the current one is among them.
    struct Cell {
        int low, high;
        std::array<float, 3> cost;  ///< of the cheapest way to the entry
        std::array<int, 3> from;    ///< the way's entry in the column before
        int stay;
    };
    /// A neighbour beside the line. It is as far from each column of the line.
    struct Beside {
        std::ptrdiff_t step;
        bool in_time;
    };

    void find_beside(std::size_t first, std::size_t along) {
        const auto around = strip_.columns().around(first, strip_.columns().place(first));
        count_ = 0;
        for (std::size_t d = 0; d < around.size(); ++d)
            if (d / 2 != along && around[d] != Columns::none)
                beside_[count_++] = {static_cast<std::ptrdiff_t>(around[d]) - static_cast<std::ptrdiff_t>(first), d / 2 == 2};
    }
    static std::size_t moved(std::size_t column, std::ptrdiff_t step) { return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(column) + step); }

    void find_room(Cell& cell, std::size_t c) const {
        const auto band = strip_[c];
        cell.stay = seam_[c];
        cell.low = std::max<int>(cell.stay - 1, band.first);
        cell.high = std::min<int>(cell.stay + 1, band.last);
        for (std::size_t n = 0; n < count_; ++n) {
            const int there = seam_[moved(c, beside_[n].step)];
            cell.low = std::max(cell.low, there - 1);
            cell.high = std::min(cell.high, there + 1);
        }
    }
    /// Cost of the step between two entries, at most 1 apart, of neighbouring columns.
    float step_cost(std::size_t column, int entry, std::size_t other, int entry_there, bool in_time) const {
        if (entry == entry_there) return 0;
        if constexpr (stepping == Stepping::rigid) return strip_.steps().lift(in_time, 0, 0);
        return entry > entry_there ? strip_.steps().lift(in_time, strip_.field(column, entry_there), strip_.field(other, entry))
                                   : strip_.steps().lift(in_time, strip_.field(other, entry), strip_.field(column, entry_there));
    }
    /// Cost of the steps to the columns beside the line.
    float to_beside(std::size_t c, int entry) const {
        float out = 0;
        for (std::size_t n = 0; n < count_; ++n) {
            const auto other = moved(c, beside_[n].step);
            out += step_cost(c, entry, other, seam_[other], beside_[n].in_time);
        }
        return out;
    }
    /// Ties go to the entry that does not move.
    static bool better(float cost, int entry, float than, int other, int stay) { return cost < than || (cost == than && entry == stay && other != stay); }
    void come_from(const Cell& before, std::size_t column_before, Cell& cell, std::size_t column, int entry, bool in_time) const {
        auto best = std::numeric_limits<float>::infinity();
        int from = before.stay;
        for (int e = std::max(entry - 1, before.low); e <= std::min(entry + 1, before.high); ++e) {
            auto cost = before.cost[static_cast<std::size_t>(e - before.low)];
            if constexpr (stepping != Stepping::free) cost += step_cost(column, entry, column_before, e, in_time);
            if (!better(cost, e, best, from, before.stay)) continue;
            best = cost;
            from = e;
        }
        cell.cost[static_cast<std::size_t>(entry - cell.low)] += best;
        cell.from[static_cast<std::size_t>(entry - cell.low)] = from;
    }
    static int cheapest(const Cell& cell) {
        int best = cell.low;
        const auto cost = [&](int entry) { return cell.cost[static_cast<std::size_t>(entry - cell.low)]; };
        for (int entry = cell.low; entry <= cell.high; ++entry)
            if (better(cost(entry), entry, cost(best), best, cell.stay)) best = entry;
        return best;
    }

    const Strip& strip_;
    std::vector<std::uint16_t>& seam_;
    std::vector<Cell> cells_;
    std::array<Beside, 4> beside_;
    std::size_t count_ = 0;
};

template <Stepping stepping>
void sweep(const Strip& strip, std::vector<std::uint16_t>& seam, int turn) {
    const auto& columns = strip.columns();
    const std::array<std::size_t, 3> size{columns.laterals(), columns.slices(), columns.frames()};
    const std::array<std::size_t, 3> step{1, columns.laterals(), columns.per_frame()};
    for (std::size_t along = 0; along < 3; ++along) {
        if (size[along] < 2) continue;
        // Of the other two dimensions, `outer` is divided among the threads.
        const std::size_t inner = along == 0 ? 1 : 0, outer = along == 2 ? 1 : 2;
        const auto still = columns.ring(along) ? static_cast<std::ptrdiff_t>(static_cast<std::size_t>(turn) * size[along] / 2 % size[along]) : -1;
        // In a ring of odd length, the last lines are neighbours of the first: they take turns of their own.
        const auto odd = [&](std::size_t d) { return d != along && columns.ring(d) && size[d] % 2 != 0; };
        const auto last_of = [&](std::size_t d, std::size_t at) { return odd(d) && at + 1 == size[d]; };
        const std::size_t rings = (odd(inner) ? 1 : 0) + (odd(outer) ? 1 : 0);
        for (std::size_t colour = 0; colour < std::size_t{2} << rings; ++colour)
            tbb::parallel_for(std::size_t{0}, size[outer], [&](std::size_t a) {
                ColumnLine<stepping> line(strip, seam);
                for (std::size_t b = 0; b < size[inner]; ++b) {
                    const std::size_t last_outer = last_of(outer, a) ? 2 : 0, last_inner = last_of(inner, b) ? (odd(outer) ? 4 : 2) : 0;
                    if ((a + b) % 2 + last_outer + last_inner != colour) continue;
                    line.improve(a * step[outer] + b * step[inner], step[along], size[along], along, still);
                }
            });
    }
}

}  // namespace

void sweep_lines(const Strip& strip, std::vector<std::uint16_t>& seam, int turn) {
    if (!strip.steps()) sweep<Stepping::free>(strip, seam, turn);
    else if (!strip.steps().has_field()) sweep<Stepping::rigid>(strip, seam, turn);
    else sweep<Stepping::field>(strip, seam, turn);
}

}  // namespace fluidcarve
