#include "carve/solver/search/strip.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace fluidcarve {

namespace {

constexpr std::size_t grain = 4096;
/// Columns whose energies are prefetched ahead.
constexpr std::size_t soon = 16;

/// Calls `call(column, its entries)` for the columns from begin to before end.
template <class Cell, class Call>
void for_columns(const EnergyVolume& energy, std::size_t begin, std::size_t end, const Call& call) {
    const auto per_frame = energy.columns_per_frame();
    for (auto c = begin; c < end; ++c)
        call(c, energy.cells<Cell>(c / per_frame) + c % per_frame * energy.stride());
}

template <class Call>
double sum_over(std::size_t count, const Call& call) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, count, grain), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double sum) {
            return sum + call(range.begin(), range.end());
        },
        std::plus<>());
}

}  // namespace

Strip::Strip(const EnergyVolume& energy, Band band, const KeptMemory& memory)
    : columns_(energy),
      band_(std::move(band)),
      width_(
          static_cast<std::size_t>(band_.columns.front().last - band_.columns.front().first + 1)),
      energies_(memory.array<float>(width_ * columns_.count() + 2 * margin)),
      steps_(energy.steps()),
      fields_(memory.array<float>(steps_.has_field() ? (width_ + 2) * columns_.count() + 2 * margin
                                                     : 0)),
      protects_(energy.protects()) {
    for (auto* const each : {&energies_, &fields_})
        if (each->size() > 0) {
            std::fill_n(each->data(), margin, 0.0f);
            std::fill_n(each->data() + each->size() - margin, margin, 0.0f);
        }
    const auto fill = [&, costs = energy.costs()](auto cell) {
        using Cell = decltype(cell);
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, columns_.count(), grain),
            [&](const tbb::blocked_range<std::size_t>& range) {
                for_columns<Cell>(
                    energy, range.begin(), range.end(), [&](std::size_t c, const Cell* cells) {
                        const auto [first, last] = band_.columns[c];
                        // Columns are far apart in memory, and little is read of each.
                        if (c + soon < range.end())
                            __builtin_prefetch(cells + soon * energy.stride() +
                                               band_.columns[c + soon].first);
                        for (std::size_t n = 0; n < width_; ++n)
                            energies_[margin + c * width_ + n] = costs(cells[first + n]);
                        if (fields_.size() == 0) return;
                        steps_.field(c)->read(first - 1,
                                              {&fields_[field_place(c, first - 1)], width_ + 2});
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

double cost_of_steps(const Columns& columns, const StepCosts& steps,
                     std::span<const std::uint16_t> seam) {
    if (!steps) return 0;
    const auto laterals = columns.laterals(), rows = columns.slices() * columns.frames();
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, rows, std::max<std::size_t>(grain / laterals, 1)), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double sum) {
            for (auto row = range.begin(); row < range.end(); ++row) {
                const auto first = row * laterals;
                const auto neighbours = columns.neighbours(first, columns.place(first));
                // The offsets to the next row and to the next frame are the same for all columns
                // of a row.
                const auto next_row = neighbours[3], next_frame = neighbours[5];
                const auto add = [&](std::size_t c, std::size_t other, bool in_time) {
                    if (seam[c] != seam[other])
                        sum += static_cast<double>(steps(c, seam[c], other, seam[other], in_time));
                };
                for (std::size_t n = 0; n < laterals; ++n) {
                    if (n + 1 < laterals) add(first + n, first + n + 1, false);
                    else if (columns.ring(0)) add(first + n, first, false);
                    if (next_row != Columns::none) add(first + n, next_row + n, false);
                    if (next_frame != Columns::none) add(first + n, next_frame + n, true);
                }
            }
            return sum;
        },
        std::plus<>());
}

double cost_of(const EnergyVolume& energy, std::span<const std::uint16_t> seam) {
    const auto add = [&, costs = energy.costs()](auto cell) {
        using Cell = decltype(cell);
        return sum_over(seam.size(), [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for_columns<Cell>(energy, begin, end, [&](std::size_t c, const Cell* cells) {
                sum += costs(cells[seam[c]]);
            });
            return sum;
        });
    };
    return (energy.summed() ? add(float{}) : add(std::uint16_t{})) +
           cost_of_steps(Columns(energy), energy.steps(), seam);
}

double energy_of(const EnergyVolume& energy, std::span<const std::uint16_t> seam) {
    if (!energy.attracts()) return cost_of(energy, seam);
    return sum_over(seam.size(),
                    [&](std::size_t begin, std::size_t end) {
                        double sum = 0;
                        if (energy.summed()) {
                            for (auto c = begin; c < end; ++c)
                                sum += energy.energies()[c * energy.stride() + seam[c]];
                        } else {
                            for_columns<std::uint16_t>(
                                energy, begin, end, [&](std::size_t c, const std::uint16_t* codes) {
                                    sum += EntryCosts{}(codes[seam[c]]);
                                });
                        }
                        return sum;
                    }) +
           cost_of_steps(Columns(energy), energy.steps(), seam);
}

double energy_bound(const EnergyVolume& energy, std::span<const std::uint16_t> seam,
                    double cost_bound) {
    if (!energy.attracts()) return cost_bound;
    return std::max(cost_bound + energy_of(energy, seam) - cost_of(energy, seam), 0.0);
}

}  // namespace fluidcarve
