#include "carve/solver/search/line_sweeps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace fluidcarve {

namespace {
/// Columns that are prefetched ahead in a line: those of a line through all frames are far apart
/// in memory.
constexpr std::size_t ahead_in_line = 8;
}  // namespace

/// One line of columns, in which a seam may move while all others stay.
template <Stepping stepping>
class LineSweeps::Line {
public:
    Line(const Strip& strip, std::vector<std::uint16_t>& seam) : strip_(strip), seam_(seam) {}

    /// Moves the seam in the line to its cheapest entries.
    /// @param first   the line's first column
    /// @param step    from a column to the next
    /// @param length  number of columns
    /// @param along   the dimension of the line: 0 lateral, 1 k, 2 t
    /// @param still   index in the line of the column that stays fixed; -1: none
    void improve(std::size_t first, std::size_t step, std::size_t length, std::size_t along,
                 std::ptrdiff_t still) {
        cells_.resize(length);
        find_beside(first, along);
        // A ring is opened at the fixed column, which then is both ends.
        const bool ring = still >= 0;
        const auto column = [&](std::size_t n) {
            return first + step * (ring ? (n + static_cast<std::size_t>(still)) % length : n);
        };
        for (std::size_t n = 0; n < length; ++n) {
            auto& cell = cells_[n];
            const auto c = column(n);
            if (n + ahead_in_line < length) {
                __builtin_prefetch(strip_.energies(column(n + ahead_in_line)));
                __builtin_prefetch(&seam_[column(n + ahead_in_line)]);
            }
            find_room(cell, c);
            if (ring && n == 0) cell.low = cell.high = seam_[c];
            if (ring && n + 1 == length) {
                const int home = seam_[column(0)];
                cell.low = std::max(cell.low, home - 1);
                cell.high = std::min(cell.high, home + 1);
            }
            cell.cost = strip_.energies(c, cell.base());
            if constexpr (stepping != Stepping::free)
                cell.cost += to_beside(c, cell.base()) +
                             (ring && n + 1 == length
                                  ? step_costs(c, cell.base(), column(0), seam_[column(0)], false)
                                  : Lanes{});
            if (n > 0) come_from(cells_[n - 1], column(n - 1), cell, c, along == 2);
        }
        auto entry = cheapest(cells_.back());
        for (auto n = length; n-- > 0;) {
            seam_[column(n)] = static_cast<std::uint16_t>(entry);
            entry = cells_[n].from[entry - cells_[n].base()];
        }
    }

private:
    /// Those entries of a column that the neighbours beside the line allow: at most three, since
    /// the current one is among them.
    struct Cell {
        int low, high, stay;
        Lanes cost;     ///< of the cheapest way to an entry, from base() on
        LaneMask from;  ///< the way's entry in the column before
        int base() const { return stay - 1; }
    };
    /// A neighbour beside the line, at the same offset from each column of the line.
    struct Beside {
        std::ptrdiff_t step;
        bool in_time;
    };

    void find_beside(std::size_t first, std::size_t along) {
        const auto neighbours = strip_.columns().neighbours(first, strip_.columns().place(first));
        count_ = 0;
        for (std::size_t d = 0; d < neighbours.size(); ++d)
            if (d / 2 != along && neighbours[d] != Columns::none)
                beside_[count_++] = {
                    static_cast<std::ptrdiff_t>(neighbours[d]) - static_cast<std::ptrdiff_t>(first),
                    d / 2 == 2};
    }
    static std::size_t away(std::size_t column, std::ptrdiff_t step) {
        return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(column) + step);
    }

    void find_room(Cell& cell, std::size_t c) const {
        const auto band = strip_[c];
        cell.stay = seam_[c];
        cell.low = std::max<int>(cell.stay - 1, band.first);
        cell.high = std::min<int>(cell.stay + 1, band.last);
        for (std::size_t n = 0; n < count_; ++n) {
            const int there = seam_[away(c, beside_[n].step)];
            cell.low = std::max(cell.low, there - 1);
            cell.high = std::min(cell.high, there + 1);
        }
    }
    /// Costs of the steps from an entry of a neighbour to entries of a column, from `base` on. Of
    /// the two values that a step puts beside each other, one is the column's at the neighbour's
    /// entry, the other the neighbour's at the column's entry (StepCosts).
    Lanes step_costs(std::size_t column, int base, std::size_t other, int entry_there,
                     bool in_time) const {
        if constexpr (stepping == Stepping::rigid)
            return without(Lanes{} + strip_.steps().price(in_time).rigidity, base, entry_there);
        return without(strip_.steps().lift(in_time, strip_.field(column, entry_there),
                                           strip_.fields(other, base)),
                       base, entry_there);
    }
    /// Costs of the steps to the columns beside the line.
    Lanes to_beside(std::size_t c, int base) const {
        Lanes out{};
        for (std::size_t n = 0; n < count_; ++n) {
            const auto other = away(c, beside_[n].step);
            out += step_costs(c, base, other, seam_[other], beside_[n].in_time);
        }
        return out;
    }
    /// Extends the cheapest ways to a column by the next one. Ties go to the entry that does not
    /// move.
    void come_from(const Cell& before, std::size_t column_before, Cell& cell, std::size_t column,
                   bool in_time) const {
        constexpr auto infinity = std::numeric_limits<float>::infinity();
        Lanes best = Lanes{} + infinity;
        LaneMask from = LaneMask{} + before.stay;
        for (int e = before.low; e <= before.high; ++e) {
            Lanes cost = Lanes{} + before.cost[e - before.base()];
            if constexpr (stepping != Stepping::free)
                cost += step_costs(column, cell.base(), column_before, e, in_time);
            const LaneMask better =
                lanes_within(e - 1, e + 1, cell.base()) &
                ((cost < best) | (e == before.stay ? cost == best : LaneMask{}));
            best = better ? cost : best;
            from = better ? LaneMask{} + e : from;
        }
        cell.cost += best;
        cell.from = from;
    }
    static int cheapest(const Cell& cell) {
        const auto cost = [&](int entry) { return cell.cost[entry - cell.base()]; };
        int best = cell.low;
        for (int entry = cell.low; entry <= cell.high; ++entry)
            if (cost(entry) < cost(best) || (cost(entry) == cost(best) && entry == cell.stay))
                best = entry;
        return best;
    }

    const Strip& strip_;
    std::vector<std::uint16_t>& seam_;
    std::vector<Cell> cells_;
    std::array<Beside, 4> beside_;
    std::size_t count_ = 0;
};

template <Stepping stepping>
void LineSweeps::sweep(std::vector<std::uint16_t>& seam, int turn) const {
    const auto& columns = strip_.columns();
    const std::array<std::size_t, 3> size{columns.laterals(), columns.slices(), columns.frames()},
        step{1, columns.laterals(), columns.per_frame()};
    for (std::size_t along = 0; along < 3; ++along) {
        if (size[along] < 2) continue;
        // Of the other two dimensions, `outer` is divided among the threads.
        const std::size_t inner = along == 0 ? 1 : 0, outer = along == 2 ? 1 : 2;
        const bool ring = columns.ring(along);
        const auto still = ring ? static_cast<std::ptrdiff_t>(static_cast<std::size_t>(turn) *
                                                              size[along] / 2 % size[along])
                                : -1;
        // In a ring of odd length, the last lines are neighbours of the first: they take turns of
        // their own.
        const auto odd = [&](std::size_t d) {
            return d != along && columns.ring(d) && size[d] % 2 != 0;
        };
        const auto last_of = [&](std::size_t d, std::size_t at) {
            return odd(d) && at + 1 == size[d];
        };
        const std::size_t rings = (odd(inner) ? 1 : 0) + (odd(outer) ? 1 : 0);
        for (std::size_t colour = 0; colour < std::size_t{2} << rings; ++colour)
            tbb::parallel_for(std::size_t{0}, size[outer], [&](std::size_t a) {
                Line<stepping> line(strip_, seam);
                for (std::size_t b = 0; b < size[inner]; ++b) {
                    const std::size_t last_outer = last_of(outer, a) ? 2 : 0,
                                      last_inner = last_of(inner, b) ? (odd(outer) ? 4 : 2) : 0;
                    if ((a + b) % 2 + last_outer + last_inner != colour) continue;
                    line.improve(a * step[outer] + b * step[inner], step[along], size[along], along,
                                 still);
                }
            });
    }
}

void LineSweeps::operator()(std::vector<std::uint16_t>& seam, int turn) const {
    if (!strip_.steps()) sweep<Stepping::free>(seam, turn);
    else if (!strip_.steps().has_field()) sweep<Stepping::rigid>(seam, turn);
    else sweep<Stepping::field>(seam, turn);
}

}  // namespace fluidcarve
