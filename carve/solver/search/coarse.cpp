#include "carve/solver/search/coarse.h"

#include "carve/solver/costs/code.h"
#include "carve/solver/costs/decode.h"
#include "carve/solver/costs/half.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace fluidcarve {

namespace {

/// Cost of a column's two entries for a seam that can mostly choose.
/// @param barrier  cost if both are protected
template <bool protects>
float cost_of_either(float a, float b, float barrier) {
    if constexpr (protects) {
        if (std::isinf(a)) a = std::isinf(b) ? barrier : b;
        if (std::isinf(b)) b = a;
    }
    return cost_of_pair(a, b);
}

/// Calls `visit(c)` for the columns that a coarse column stands for.
template <class Visit>
void each_fine(const Columns& fine, const Columns::Place& coarse, const Visit& visit) {
    const auto end = [](std::size_t at, std::size_t size) { return std::min(2 * at + 2, size); };
    for (auto t = 2 * coarse.t; t < end(coarse.t, fine.frames()); ++t)
        for (auto k = 2 * coarse.slice; k < end(coarse.slice, fine.slices()); ++k)
            for (auto lateral = 2 * coarse.lateral; lateral < end(coarse.lateral, fine.laterals());
                 ++lateral)
                visit(fine.at(lateral, k, t));
}

/// Restricts a row of columns along the lateral dimension, `[lateral][entry]`.
template <class Cell, bool protects>
void restrict_row(const EnergyVolume& energy, Window window, float barrier, const Columns& coarse,
                  std::size_t k, std::size_t t, std::vector<float>& out) {
    const Columns fine(energy);
    const auto width = static_cast<std::size_t>(window.size()), coarse_width = halved(width);
    const auto cost = energy.costs();
    std::ranges::fill(out, 0.0f);
    std::vector<float> closed(protects ? coarse_width
                                       : 0);  // columns in which an entry can't be taken
    const bool plain = std::is_same_v<Cell, std::uint16_t> && !protects && !energy.attracts();
    std::vector<float> energies(plain ? width : 0);
    const auto add = [&](float& sum, std::size_t n, float value) {
        if constexpr (protects) {
            if (std::isinf(value)) {
                ++closed[n];
                return;
            }
        }
        sum += value;
    };
    const auto add_column = [&](const Cell* cells, float* sums) {
        if constexpr (std::is_same_v<Cell, std::uint16_t>)
            if (plain) {
                decode_energies({cells, width}, energies);
                return add_pairs(energies, {sums, coarse_width});
            }
        for (std::size_t n = 0; n < width / 2; ++n)
            add(sums[n], n,
                cost_of_either<protects>(cost(cells[2 * n]), cost(cells[2 * n + 1]), barrier));
        if (width % 2 != 0) {
            const auto last = cost(cells[width - 1]);
            add(sums[coarse_width - 1], coarse_width - 1,
                protects && std::isinf(last) ? barrier : last);
        }
    };
    for (std::size_t lateral = 0; lateral < coarse.laterals(); ++lateral) {
        auto* const sums = out.data() + lateral * coarse_width;
        std::ranges::fill(closed, 0.0f);
        float count = 0;
        each_fine(fine, {lateral, k, t}, [&](std::size_t c) {
            ++count;
            add_column(energy.cells<Cell>(0) + c * energy.stride() + window.first, sums);
        });
        for (std::size_t n = 0; n < coarse_width; ++n) {
            if constexpr (protects)
                sums[n] = closed[n] < count ? sums[n] / (count - closed[n]) : barrier;
            else sums[n] /= count;
        }
    }
}

/// Columns whose field is restricted at once.
constexpr std::size_t columns_at_once = std::size_t{1} << 16;

/// Restricts a field: each entry gets the mean of what it stands for.
void restrict_field(const EnergyVolume& energy, Window window, const Columns& coarse,
                    EnergyVolume& out) {
    const Columns fine(energy);
    // A few frames at once: their coarse field is never held as a whole.
    const auto at_once =
        std::min(std::max(columns_at_once / coarse.per_frame(), std::size_t{1}), coarse.frames());
    std::vector<std::uint16_t> codes(at_once * coarse.per_frame() * out.stride());
    for (std::size_t first_frame = 0; first_frame < coarse.frames(); first_frame += at_once) {
        const auto frames = std::min(at_once, coarse.frames() - first_frame);
        tbb::parallel_for(std::size_t{0}, coarse.slices() * frames, [&](std::size_t row) {
            const auto k = row % coarse.slices(), t = first_frame + row / coarse.slices();
            MeanField mean(static_cast<std::size_t>(window.size()));
            for (std::size_t lateral = 0; lateral < coarse.laterals(); ++lateral) {
                each_fine(fine, {lateral, k, t}, [&](std::size_t c) {
                    const auto& field = energy.field(c);
                    const int first = std::max(field.first, window.first),
                              end = std::min(field.end, window.last + 1);
                    if (first >= end) mean.add({});
                    else
                        mean.add({field.codes + (first - field.first),
                                  field.codes + (end - field.first)},
                                 static_cast<std::size_t>(first - window.first));
                });
                mean.end(std::span(codes).subspan(
                    (lateral + coarse.laterals() * row) * out.stride(), out.stride()));
            }
        });
        out.set_field(first_frame,
                      std::span(codes).first(frames * coarse.per_frame() * out.stride()));
    }
}

template <class Cell, bool protects>
EnergyVolume restricted(const EnergyVolume& energy, Window window, float barrier) {
    const Columns fine(energy);
    auto shape = energy.shape();
    shape.lattice = {halved(window.size()), halved(energy.laterals()), halved(energy.slices())};
    shape.frames = halved(fine.frames());
    const Columns coarse(shape);
    const auto row_size = static_cast<std::size_t>(shape.lattice[0]) * coarse.laterals();
    const auto for_rows = [&](const auto& take) {
        tbb::parallel_for(std::size_t{0}, coarse.slices() * coarse.frames(), [&](std::size_t row) {
            std::vector<float> costs(row_size);
            restrict_row<Cell, protects>(energy, window, barrier, coarse, row % coarse.slices(),
                                         row / coarse.slices(), costs);
            take(row, costs);
        });
    };
    // Codes cannot hold costs below 0.
    if (energy.summed() || energy.attracts()) {
        std::vector<float> costs(row_size * coarse.slices() * coarse.frames());
        for_rows([&](std::size_t row, const std::vector<float>& of_row) {
            std::ranges::copy(of_row, costs.begin() + static_cast<std::ptrdiff_t>(row * row_size));
        });
        return EnergyVolume(shape, {}, std::move(costs));
    }
    EnergyVolume out(shape);
    const auto most = decode_energy(highest_energy_code);
    for_rows([&](std::size_t row, const std::vector<float>& of_row) {
        auto* const codes =
            out.codes(row / coarse.slices()).data() + row % coarse.slices() * row_size;
        for (std::size_t n = 0; n < row_size; ++n)
            codes[n] =
                std::isinf(of_row[n]) ? protected_code : encode_energy(std::min(of_row[n], most));
    });
    if (protects && std::isinf(barrier)) out.find_marks();
    return out;
}

/// The two coarse places around a fine one, and the weight of the nearer, in quarters: 4 if it is
/// the only one.
struct CoarsePlaces {
    std::size_t near, other;
    int weight;
};

CoarsePlaces coarse_places(std::size_t fine, std::size_t fine_size, bool ring) {
    const auto size = halved(fine_size), near = fine / 2;
    if (fine_size < 2) return {near, near, 4};
    if (fine % 2 == 0) return {near, near > 0 ? near - 1 : ring ? size - 1 : near, 3};
    return {near, near + 1 < size ? near + 1 : ring ? 0 : near, 3};
}

}  // namespace

EnergyVolume restrict_energy(const EnergyVolume& energy, Window window, float barrier) {
    const auto in = [&](auto cell) {
        using Cell = decltype(cell);
        return energy.protects() ? restricted<Cell, true>(energy, window, barrier)
                                 : restricted<Cell, false>(energy, window, barrier);
    };
    auto out = energy.summed() ? in(float{}) : in(std::uint16_t{});
    auto prices = energy.step_prices();
    prices.edge /= 2;  // coarse edges are twice as long
    out.set_step_prices(prices);
    if (energy.has_field()) restrict_field(energy, window, Columns(out), out);
    return out;
}

std::vector<std::uint16_t> prolong_seam(const Columns& coarse, std::span<const std::uint16_t> seam,
                                        const Columns& fine, Window window) {
    std::vector<std::uint16_t> out(fine.count());
    tbb::parallel_for(std::size_t{0}, fine.slices() * fine.frames(), [&](std::size_t row) {
        const auto k = coarse_places(row % fine.slices(), fine.slices(), fine.ring(1)),
                   t = coarse_places(row / fine.slices(), fine.frames(), false);
        for (std::size_t l = 0; l < fine.laterals(); ++l) {
            const auto lateral = coarse_places(l, fine.laterals(), fine.ring(0));
            int sum = 0;
            for (int corner = 0; corner < 8; ++corner) {
                const auto pick = [&](const CoarsePlaces& b, int bit) {
                    return corner >> bit & 1 ? std::pair(b.other, 4 - b.weight)
                                             : std::pair(b.near, b.weight);
                };
                const auto [cl, wl] = pick(lateral, 0);
                const auto [ck, wk] = pick(k, 1);
                const auto [ct, wt] = pick(t, 2);
                sum += wl * wk * wt * seam[coarse.at(cl, ck, ct)];
            }
            // Coarse entry i stands for fine entries 2i and 2i + 1.
            out[row * fine.laterals() + l] = static_cast<std::uint16_t>(
                std::min(window.first + (2 * sum + 32) / 64, window.last));
        }
    });
    // In a ring of odd length, the last coarse column is half as long. The seam may be too steep
    // there.
    for (bool again = (fine.ring(0) && fine.laterals() % 2 != 0) ||
                      (fine.ring(1) && fine.slices() % 2 != 0);
         again;) {
        again = false;
        for (std::size_t c = 0; c < out.size(); ++c)
            for (const auto other : fine.neighbours(c, fine.place(c)))
                if (other != Columns::none && out[c] > out[other] + 1) {
                    out[c] = static_cast<std::uint16_t>(out[other] + 1);
                    again = true;
                }
    }
    return out;
}

}  // namespace fluidcarve
