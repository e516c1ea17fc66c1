#pragma once

#include "carve/solver/costs/code.h"
#include "carve/solver/costs/energy_volume.h"
#include "carve/solver/search/band.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

/// Oracles for solvers: volumes so small that all of their seams can be tried.
namespace fluidcarve::test {

using SeamVector = std::vector<std::uint16_t>;

/// The columns of a volume, lateral fastest, then k, then t, and which of them are neighbours, in
/// lists.
struct ColumnGraph {
    std::array<int, 3> size;  ///< laterals, slices, frames
    bool closed, around;
    std::vector<std::vector<std::size_t>> neighbours;

    explicit ColumnGraph(const std::array<int, 3>& size, bool closed = false, bool around = false)
        : size(size), closed(closed), around(around) {
        const auto at = [&](int lateral, int k, int t) {
            return static_cast<std::size_t>(lateral + size[0] * (k + size[1] * t));
        };
        neighbours.resize(at(0, 0, size[2]));
        const auto join = [&](std::size_t one, std::size_t other) {
            if (one == other) return;
            neighbours[one].push_back(other);
            neighbours[other].push_back(one);
        };
        for (int t = 0; t < size[2]; ++t)
            for (int k = 0; k < size[1]; ++k)
                for (int lateral = 0; lateral < size[0]; ++lateral) {
                    if (lateral > 0) join(at(lateral, k, t), at(lateral - 1, k, t));
                    if (around && lateral == 0) join(at(lateral, k, t), at(size[0] - 1, k, t));
                    if (k > 0) join(at(lateral, k, t), at(lateral, k - 1, t));
                    if (closed && k == 0) join(at(lateral, k, t), at(lateral, size[1] - 1, t));
                    if (t > 0) join(at(lateral, k, t), at(lateral, k, t - 1));
                }
    }
    std::size_t count() const { return neighbours.size(); }
};

/// Whether neighbours differ by at most 1 and no entry leaves the band.
template <class Entries>
bool is_seam(const ColumnGraph& graph, const Band& band, const Entries& at) {
    if (at.size() != graph.count()) return false;
    for (std::size_t c = 0; c < graph.count(); ++c) {
        if (at[c] < band.columns[c].first || at[c] > band.columns[c].last) return false;
        for (const auto other : graph.neighbours[c])
            if (std::abs(at[c] - at[other]) > 1) return false;
    }
    return true;
}

/// Lowers entries until they are a seam.
inline void make_seam(const ColumnGraph& graph, SeamVector& at) {
    for (bool again = true; again;) {
        again = false;
        for (std::size_t c = 0; c < at.size(); ++c)
            for (const auto other : graph.neighbours[c])
                if (at[c] > at[other] + 1) {
                    at[c] = static_cast<std::uint16_t>(at[other] + 1);
                    again = true;
                }
    }
}

inline SeamVector random_seam(std::mt19937& random, const ColumnGraph& graph, Window window) {
    SeamVector out(graph.count());
    for (auto& entry : out)
        entry = static_cast<std::uint16_t>(
            window.first + static_cast<int>(random() % static_cast<unsigned>(window.size())));
    make_seam(graph, out);
    return out;
}

/// Intervals of their own for each column, that begin and end in seams.
inline Band random_band(std::mt19937& random, const ColumnGraph& graph, Window window) {
    const auto one = random_seam(random, graph, window), other = random_seam(random, graph, window);
    Band out;
    for (std::size_t c = 0; c < one.size(); ++c)
        out.columns.push_back({std::min(one[c], other[c]), std::max(one[c], other[c])});
    return out;
}

using CostAt = std::function<double(std::size_t column, int entry)>;

/// What being at two entries in neighbouring columns costs.
using StepAt =
    std::function<double(std::size_t column, int entry, std::size_t other, int entry_there)>;

template <class Entries>
double sum_along(const Entries& at, const CostAt& cost) {
    double out = 0;
    for (std::size_t c = 0; c < at.size(); ++c) out += cost(c, at[c]);
    return out;
}

template <class Entries>
double sum_of_steps(const ColumnGraph& graph, const Entries& at, const StepAt& step) {
    double out = 0;
    for (std::size_t c = 0; c < at.size(); ++c)
        for (const auto other : graph.neighbours[c])
            if (other < c) out += step(c, at[c], other, at[other]);
    return out;
}

/// The least cost of all seams in a band, and of those that cost no more the lowest and the
/// highest; those are seams too.
struct Least {
    double cost = std::numeric_limits<double>::infinity();
    SeamVector lowest, highest;
};

class BruteForce {
public:
    /// @param step  0 or more; none: steps are free
    BruteForce(const ColumnGraph& graph, const Band& band, const CostAt& cost, const StepAt& step)
        : graph_(graph), band_(band), step_(step), costs_(graph.count()), rest_(graph.count() + 1) {
        for (auto c = graph.count(); c-- > 0;) {
            for (int entry = band.columns[c].first; entry <= band.columns[c].last; ++entry)
                costs_[c].push_back(cost(c, entry));
            rest_[c] = rest_[c + 1] + *std::ranges::min_element(costs_[c]);
        }
        at_.resize(graph.count());
        descend(0, 0);
    }
    const Least& least() const { return least_; }

private:
    /// Tries all entries of a column and, with each, all that can follow.
    /// @param sum  of the columns before
    void descend(std::size_t c, double sum) {
        if (sum + rest_[c] > least_.cost) return;
        if (c == at_.size()) return take(sum);
        for (int entry = band_.columns[c].first; entry <= band_.columns[c].last; ++entry) {
            bool fits = true;
            double paid = sum + costs_[c][static_cast<std::size_t>(entry - band_.columns[c].first)];
            for (const auto other : graph_.neighbours[c]) {
                if (other > c) continue;
                fits = fits && std::abs(entry - at_[other]) <= 1;
                if (fits && step_) paid += step_(c, entry, other, at_[other]);
            }
            if (!fits) continue;
            at_[c] = static_cast<std::uint16_t>(entry);
            descend(c + 1, paid);
        }
    }
    void take(double sum) {
        if (sum < least_.cost) least_ = {sum, at_, at_};
        for (std::size_t c = 0; c < at_.size(); ++c) {
            least_.lowest[c] = std::min(least_.lowest[c], at_[c]);
            least_.highest[c] = std::max(least_.highest[c], at_[c]);
        }
    }

    const ColumnGraph& graph_;
    const Band& band_;
    const StepAt& step_;
    std::vector<std::vector<double>> costs_;
    std::vector<double> rest_;  ///< what the columns from one on cost at least
    SeamVector at_;
    Least least_;
};

inline Least brute_force(const ColumnGraph& graph, const Band& band, const CostAt& cost,
                         const StepAt& step = nullptr) {
    return BruteForce(graph, band, cost, step).least();
}

/// Sizes of a volume of at most so many columns: lines, planes, volumes and sequences of them.
inline std::array<int, 3> random_size(std::mt19937& random, int most_columns) {
    std::array<int, 3> out{1, 1, 1};
    for (std::size_t n = 0, d = random() % 3; n < 3; ++n, d = (d + 1) % 3) {
        const int most = most_columns / (out[0] * out[1] * out[2]);
        out[d] = 1 + static_cast<int>(random() %
                                      static_cast<unsigned>(n == 2 ? most : std::min(most, 4)));
    }
    return out;
}

inline EnergyVolume volume_of(const ColumnGraph& graph, int width, const CostAt& energy) {
    EnergyVolume out({{width, graph.size[0], graph.size[1]},
                      Axis::u,
                      static_cast<std::size_t>(graph.size[2]),
                      graph.closed,
                      graph.around});
    for (std::size_t c = 0; c < graph.count(); ++c)
        for (int entry = 0; entry < width; ++entry)
            out.codes(c / out.columns_per_frame())[c % out.columns_per_frame() * out.stride() +
                                                   static_cast<std::size_t>(entry)] =
                encode_energy(static_cast<float>(energy(c, entry)));
    return out;
}

/// Gives an energy a field.
/// @param value  called with a frame and a place, laid out as its energies
template <class ValueAt>
void add_field(EnergyVolume& energy, float weight, const ValueAt& value) {
    auto prices = energy.step_prices();
    prices.edge = weight;
    energy.set_step_prices(prices);
    for (std::size_t t = 0; t < energy.frames(); ++t) {
        std::vector<std::uint16_t> codes;
        for (std::size_t n = 0; n < energy.columns_per_frame() * energy.stride(); ++n)
            codes.push_back(encode_field(static_cast<float>(value(t, n))));
        energy.set_field(t, codes);
    }
}

/// The energies of a volume, as the solvers see them.
inline CostAt energies_of(const EnergyVolume& energy) {
    return [&](std::size_t c, int entry) -> double {
        const auto cell =
            c % energy.columns_per_frame() * energy.stride() + static_cast<std::size_t>(entry);
        return energy.summed() ? energy.cells<float>(c / energy.columns_per_frame())[cell]
                               : decode_energy(energy.codes(c / energy.columns_per_frame())[cell]);
    };
}

/// Multiples of 1/64, which neither codes nor sums round.
inline EnergyVolume random_volume(std::mt19937& random, const ColumnGraph& graph, int width,
                                  unsigned levels = 1024) {
    return volume_of(graph, width,
                     [&](std::size_t, int) { return static_cast<double>(random() % levels) / 64; });
}

inline Window random_window(std::mt19937& random, int width) {
    const int first = static_cast<int>(random() % static_cast<unsigned>(width));
    return {first, first + static_cast<int>(random() % static_cast<unsigned>(width - first))};
}

}  // namespace fluidcarve::test
