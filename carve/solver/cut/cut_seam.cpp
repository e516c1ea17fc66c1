#include "carve/solver/cut/cut_seam.h"

#include "carve/solver/search/protection.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace fluidcarve {

namespace {

/// Limit for the cost of a step, in multiples of the range of entry costs: beyond, a step is hardly
/// ever worth it.
constexpr float most_lift_of_range = 1024;
/// By which factor scaled step costs may exceed scaled energies.
constexpr float room_for_lifts = 8;

/// Cost of the most expensive step in a band.
float highest_lift(const Columns& columns, const Band& band, const StepCosts& steps) {
    if (!steps) return 0;
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, columns.count(), 4096), 0.0f,
        [&](const tbb::blocked_range<std::size_t>& range, float out) {
            for (auto c = range.begin(); c < range.end(); ++c) {
                const auto around = columns.around(c, columns.place(c));
                for (std::size_t d = 0; d < around.size(); ++d)
                    for (int entry = band.columns[c].first;
                         around[d] != Columns::none && entry <= band.columns[c].last; ++entry)
                        if (entry > 0 && entry - 1 >= band.columns[around[d]].first &&
                            entry - 1 <= band.columns[around[d]].last)
                            out = std::max(out, steps.lift(c, around[d], entry - 1, d / 2 == 2));
            }
            return out;
        },
        [](float a, float b) { return std::max(a, b); });
}

/// Cuts a band with costs from any source.
/// @param cost_at   called with (column, entry)
/// @param protects  whether some cost is infinite
template <class CostAt>
CutSeam solve(const Columns& columns, const Band& whole, const CostAt& cost_at,
              const StepCosts& steps, bool protects, double tolerance, int number,
              const std::function<void()>& tick) {
    const auto band = protects ? tightened(columns, whole, cost_at) : whole;
    struct Span {
        float low = 0, high = 0;
    };
    const auto span = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, columns.count(), 4096), Span{},
        [&](const tbb::blocked_range<std::size_t>& range, Span out) {
            for (auto c = range.begin(); c < range.end(); ++c)
                for (int entry = band.columns[c].first; entry <= band.columns[c].last; ++entry) {
                    const auto cost = cost_at(c, entry);
                    out.low = std::min(out.low, cost);
                    if (!std::isinf(cost)) out.high = std::max(out.high, cost);
                }
            return out;
        },
        [](const Span& a, const Span& b) {
            return Span{std::min(a.low, b.low), std::max(a.high, b.high)};
        });
    // If some costs are below 0, each column's costs count from its lowest, so that `tolerance` is
    // a share of the costs in which seams differ.
    std::vector<float> lows(span.low < 0 ? columns.count() : 0);
    for (std::size_t c = 0; c < lows.size(); ++c) {
        lows[c] = cost_at(c, band.columns[c].first);
        for (int entry = band.columns[c].first; entry <= band.columns[c].last; ++entry)
            lows[c] = std::min(lows[c], cost_at(c, entry));
    }
    const auto sum_of_lows = std::accumulate(lows.begin(), lows.end(), 0.0);
    // The scale is a power of two, so that costs that fit into the bits are not rounded. High step
    // costs must not push energies out of the bits. Besides, a column's ends may also pay for steps
    // to all neighbours.
    int exponent = 0;
    const float range = span.high - span.low, most_lift = most_lift_of_range * range;
    std::frexp(
        std::max(range, std::min(most_lift, highest_lift(columns, band, steps)) / room_for_lifts),
        &exponent);
    for (int bits = steps ? 23 : 24;; bits -= 6) {
        const double scale = std::ldexp(1.0, bits - exponent);
        const auto cost_of = [&](std::size_t c, Band::Column range, std::int32_t* costs) {
            const double low = lows.empty() ? 0.0 : lows[c];
            for (int entry = range.first; entry <= range.last; ++entry) {
                const double cost = cost_at(c, entry);
                *costs++ = std::isinf(cost) ? Cut::endless
                                            : static_cast<std::int32_t>(scale * (cost - low));
            }
        };
        const auto lifts_of = [&](std::size_t high, std::size_t low, bool in_time, int first,
                                  std::span<std::int32_t> lifts) {
            for (auto& lift : lifts)
                lift = static_cast<std::int32_t>(
                    scale * std::min(steps.lift(high, low, first++, in_time), most_lift));
        };
        Cut cut(columns, band, cost_of, steps ? Cut::LiftsOf(lifts_of) : nullptr, number % 2 != 0);
        // If more flow gathers than an arc holds, the cut is repeated with a smaller scale.
        if (cut.solve(tolerance, tick))
            return {cut.seam(), static_cast<double>(cut.flow()) / scale + sum_of_lows};
    }
}

}  // namespace

CutSeam cut_seam(const EnergyVolume& energy, const Band& band, double tolerance, int number,
                 const std::function<void()>& tick) {
    return with_costs(energy, [&](const auto& cost_at) {
        return solve(Columns(energy), band, cost_at, energy.steps(), energy.protects(), tolerance,
                     number, tick);
    });
}

Seams::Seam exact_seam(const EnergyVolume& energy, Window window, int number,
                       const std::function<void()>& tick) {
    auto cut = cut_seam(energy, Band::whole(Columns(energy).count(), window), 0, number, tick);
    const auto sum = energy_of(energy, cut.at),
               bound = energy_bound(energy, cut.at, cut.lower_bound);
    return {std::move(cut.at), sum, bound};
}

Seams::Seam keyframed_seam(const EnergyVolume& energy, Window window, int number, int interval,
                           double threshold, const std::function<void()>& tick) {
    const Columns all(energy);
    std::vector<std::uint16_t> at;
    for (std::size_t begin = 0; begin < all.frames(); begin += static_cast<std::size_t>(interval)) {
        const auto frames = std::min(static_cast<std::size_t>(interval), all.frames() - begin);
        // The band of all columns that are left. The seam may drift from the last finished frame by
        // one entry per frame.
        const Columns rest(static_cast<int>(all.laterals()), static_cast<int>(all.slices()),
                           static_cast<int>(all.frames() - begin), all.ring(1), all.ring(0));
        auto band = Band::whole(rest.count(), window);
        for (std::size_t c = 0; begin > 0 && c < rest.count(); ++c) {
            const int home = at[begin * all.per_frame() - all.per_frame() + c % all.per_frame()],
                      reach = static_cast<int>(c / all.per_frame()) + 1;
            band.columns[c] = {static_cast<std::uint16_t>(std::max(home - reach, window.first)),
                               static_cast<std::uint16_t>(std::min(home + reach, window.last))};
        }
        auto part = with_costs(energy, [&](const auto& cost_at) {
            const auto steps = energy.steps().from(begin * all.per_frame());
            // Cost of the step from the frame before, where the seam is known.
            const auto step_there = [&](std::size_t c, int entry) {
                if (begin == 0 || c >= all.per_frame()) return 0.0f;
                const auto here = begin * all.per_frame() + c, before = here - all.per_frame();
                return energy.steps()(here, entry, before, at[before], true);
            };
            const auto later = [&](std::size_t c, int entry) {
                return cost_at(begin * all.per_frame() + c, entry) + step_there(c, entry);
            };
            const auto above_threshold = [&](std::size_t c, int entry) {
                const auto cost = cost_at(begin * all.per_frame() + c, entry);
                return (cost > 0 && cost < threshold ? 0.0f : cost) + step_there(c, entry);
            };
            if (energy.protects()) band = tightened(rest, band, later);
            const Columns columns(static_cast<int>(all.laterals()), static_cast<int>(all.slices()),
                                  static_cast<int>(frames), all.ring(1), all.ring(0));
            auto cut =
                solve(columns,
                      {{band.columns.begin(),
                        band.columns.begin() + static_cast<std::ptrdiff_t>(columns.count())}},
                      above_threshold, steps, energy.protects(), 0, number, tick)
                    .at;
            if (!energy.protects()) return cut;
            // Later frames may be blocked from here: extend the seam to them and move it aside as
            // a whole.
            for (auto c = cut.size(); c < rest.count(); ++c) {
                const auto [first, last] = band.columns[c];
                cut.push_back(std::clamp(cut[c - all.per_frame()], first, last));
            }
            cut = moved_aside(rest, cut, band, later, steps);
            cut.resize(columns.count());
            return cut;
        });
        at.insert(at.end(), part.begin(), part.end());
    }
    const auto sum = energy_of(energy, at);
    return {std::move(at), sum};
}

CutSeam cut_seam(const Strip& strip, std::span<const std::uint16_t> seam, int radius,
                 double tolerance, int number, const std::function<void()>& tick) {
    Band band;
    band.columns.reserve(seam.size());
    for (std::size_t c = 0; c < seam.size(); ++c)
        band.columns.push_back(
            {static_cast<std::uint16_t>(std::max<int>(seam[c] - radius, strip[c].first)),
             static_cast<std::uint16_t>(std::min<int>(seam[c] + radius, strip[c].last))});
    return solve(
        strip.columns(), band, [&](std::size_t c, int entry) { return strip.energy(c, entry); },
        strip.steps(), strip.protects(), tolerance, number, tick);
}

}  // namespace fluidcarve
