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
constexpr int room_for_lifts = 8;
/// Bits of a scaled energy: with steps, and without.
constexpr int bits_beside_steps = 23, bits_alone = 24;
static_assert((1 << bits_beside_steps) * room_for_lifts <= Cut::most_cost);

/// Cost of the most expensive step in a band.
float highest_lift(const Columns& columns, const Band& band, const StepCosts& steps) {
    if (!steps) return 0;
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, columns.count(), 4096), 0.0f,
        [&](const tbb::blocked_range<std::size_t>& range, float out) {
            for (auto c = range.begin(); c < range.end(); ++c) {
                const auto neighbours = columns.neighbours(c, columns.place(c));
                for (std::size_t d = 0; d < neighbours.size(); ++d)
                    for (int entry = band.columns[c].first;
                         neighbours[d] != Columns::none && entry <= band.columns[c].last; ++entry)
                        if (entry > 0 && entry - 1 >= band.columns[neighbours[d]].first &&
                            entry - 1 <= band.columns[neighbours[d]].last)
                            out =
                                std::max(out, steps.lift(c, neighbours[d], entry - 1, d / 2 == 2));
            }
            return out;
        },
        [](float a, float b) { return std::max(a, b); });
}

/// The lowest cost of entries of a band, at most 0, and the highest that is finite.
struct CostSpan {
    float low = 0, high = 0;
};

template <class CostAt>
CostSpan cost_span(const Band& band, const CostAt& cost_at) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, band.columns.size(), 4096), CostSpan{},
        [&](const tbb::blocked_range<std::size_t>& range, CostSpan out) {
            for (auto c = range.begin(); c < range.end(); ++c)
                for (int entry = band.columns[c].first; entry <= band.columns[c].last; ++entry) {
                    const auto cost = cost_at(c, entry);
                    out.low = std::min(out.low, cost);
                    if (!std::isinf(cost)) out.high = std::max(out.high, cost);
                }
            return out;
        },
        [](const CostSpan& a, const CostSpan& b) {
            return CostSpan{std::min(a.low, b.low), std::max(a.high, b.high)};
        });
}

template <class CostAt>
std::vector<float> lowest_costs(const Band& band, const CostAt& cost_at) {
    std::vector<float> out(band.columns.size());
    for (std::size_t c = 0; c < out.size(); ++c) {
        out[c] = cost_at(c, band.columns[c].first);
        for (int entry = band.columns[c].first; entry <= band.columns[c].last; ++entry)
            out[c] = std::min(out[c], cost_at(c, entry));
    }
    return out;
}

/// How a seam is searched by cuts.
struct Search {
    bool protects;  ///< whether some cost is infinite
    double tolerance;
    int number;
    const std::function<void()>& check;
};

/// Cuts a band with costs from any source.
/// @param cost_at  called with (column, entry)
template <class CostAt>
CutSeam solve(const Columns& columns, const Band& whole, const CostAt& cost_at,
              const StepCosts& steps, const Search& search) {
    const auto band = search.protects ? tightened(columns, whole, cost_at) : whole;
    const auto span = cost_span(band, cost_at);
    // If some costs are below 0, each column's costs count from its lowest, so that `tolerance` is
    // a share of the costs in which seams differ.
    const auto lows = span.low < 0 ? lowest_costs(band, cost_at) : std::vector<float>();
    const auto sum_of_lows = std::accumulate(lows.begin(), lows.end(), 0.0);
    // The scale is a power of two, so that costs that fit into the bits are not rounded. High step
    // costs must not push energies out of the bits. Besides, a column's ends may also pay for steps
    // to all neighbours.
    int exponent = 0;
    const float range = span.high - span.low, most_lift = most_lift_of_range * range;
    std::frexp(
        std::max(range, std::min(most_lift, highest_lift(columns, band, steps)) / room_for_lifts),
        &exponent);
    for (int bits = steps ? bits_beside_steps : bits_alone;; bits -= 6) {
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
        Cut cut(columns, band, cost_of, steps ? Cut::LiftsOf(lifts_of) : nullptr,
                search.number % 2 != 0);
        // If more flow gathers than an arc holds, the cut is repeated with a smaller scale.
        if (cut.solve(search.tolerance, search.check))
            return {cut.seam(), static_cast<double>(cut.flow()) / scale + sum_of_lows};
    }
}

/// Finds a seam from keyframe to keyframe.
class KeyframedSeam {
public:
    KeyframedSeam(const EnergyVolume& energy, Window window, double threshold, const Search& search)
        : energy_(energy), all_(energy), window_(window), threshold_(threshold), search_(search) {}

    /// Adds some frames.
    void go_on(std::size_t frames) {
        const auto part =
            with_costs(energy_, [&](const auto& cost_at) { return next_frames(frames, cost_at); });
        at_.insert(at_.end(), part.begin(), part.end());
    }
    std::vector<std::uint16_t> at() && { return std::move(at_); }

private:
    /// The columns of so many frames.
    Columns columns(std::size_t frames) const {
        return {static_cast<int>(all_.laterals()), static_cast<int>(all_.slices()),
                static_cast<int>(frames), all_.ring(1), all_.ring(0)};
    }
    /// The band of all columns that are left. The seam may drift from the last finished frame by
    /// one entry per frame.
    Band band_left(const Columns& rest) const {
        auto out = Band::whole(rest.count(), window_);
        const auto per_frame = all_.per_frame();
        for (std::size_t c = 0; !at_.empty() && c < rest.count(); ++c) {
            const int home = at_[at_.size() - per_frame + c % per_frame],
                      reach = static_cast<int>(c / per_frame) + 1;
            out.columns[c] = {static_cast<std::uint16_t>(std::max(home - reach, window_.first)),
                              static_cast<std::uint16_t>(std::min(home + reach, window_.last))};
        }
        return out;
    }
    template <class CostAt>
    std::vector<std::uint16_t> next_frames(std::size_t frames, const CostAt& cost_at) const {
        const auto first = at_.size();
        const auto rest = columns(all_.frames() - first / all_.per_frame()), now = columns(frames);
        const auto steps = energy_.steps().from(first);
        // Cost of the step from the frame before, where the seam is known.
        const auto step_there = [&](std::size_t c, int entry) {
            if (first == 0 || c >= all_.per_frame()) return 0.0f;
            const auto before = first + c - all_.per_frame();
            return energy_.steps()(first + c, entry, before, at_[before], true);
        };
        const auto later = [&](std::size_t c, int entry) {
            return cost_at(first + c, entry) + step_there(c, entry);
        };
        const auto above_threshold = [&](std::size_t c, int entry) {
            const auto cost = cost_at(first + c, entry);
            return (cost > 0 && cost < threshold_ ? 0.0f : cost) + step_there(c, entry);
        };
        auto band = band_left(rest);
        if (energy_.protects()) band = tightened(rest, band, later);
        const auto count = static_cast<std::ptrdiff_t>(now.count());
        auto cut = solve(now, {{band.columns.begin(), band.columns.begin() + count}},
                         above_threshold, steps, search_)
                       .at;
        if (!energy_.protects()) return cut;
        // Later frames may find no way on from here: extend the seam to them and move it aside as a
        // whole.
        for (auto c = cut.size(); c < rest.count(); ++c)
            cut.push_back(
                std::clamp(cut[c - all_.per_frame()], band.columns[c].first, band.columns[c].last));
        cut = moved_aside(rest, cut, band, later, steps);
        cut.resize(now.count());
        return cut;
    }

    const EnergyVolume& energy_;
    const Columns all_;
    const Window window_;
    const double threshold_;
    const Search& search_;
    std::vector<std::uint16_t> at_;
};

}  // namespace

CutSeam cut_seam(const EnergyVolume& energy, const Band& band, double tolerance, int number,
                 const std::function<void()>& check) {
    return with_costs(energy, [&](const auto& cost_at) {
        return solve(Columns(energy), band, cost_at, energy.steps(),
                     {energy.protects(), tolerance, number, check});
    });
}

Seams::Seam exact_seam(const EnergyVolume& energy, Window window, int number,
                       const std::function<void()>& check) {
    auto cut = cut_seam(energy, Band::whole(Columns(energy).count(), window), 0, number, check);
    const auto sum = energy_of(energy, cut.at),
               bound = energy_bound(energy, cut.at, cut.lower_bound);
    return {std::move(cut.at), sum, bound};
}

Seams::Seam keyframed_seam(const EnergyVolume& energy, Window window, int number, int interval,
                           double threshold, const std::function<void()>& check) {
    const Search search{energy.protects(), 0, number, check};
    KeyframedSeam seam(energy, window, threshold, search);
    const auto most = static_cast<std::size_t>(interval);
    for (std::size_t begin = 0; begin < energy.frames(); begin += most)
        seam.go_on(std::min(most, energy.frames() - begin));
    auto at = std::move(seam).at();
    const auto sum = energy_of(energy, at);
    return {std::move(at), sum};
}

CutSeam cut_seam(const Strip& strip, std::span<const std::uint16_t> seam, int radius,
                 double tolerance, int number, const std::function<void()>& check) {
    Band band;
    band.columns.reserve(seam.size());
    for (std::size_t c = 0; c < seam.size(); ++c)
        band.columns.push_back(
            {static_cast<std::uint16_t>(std::max<int>(seam[c] - radius, strip[c].first)),
             static_cast<std::uint16_t>(std::min<int>(seam[c] + radius, strip[c].last))});
    return solve(strip.columns(), band,
                 [&](std::size_t c, int entry) { return strip.energy(c, entry); }, strip.steps(),
                 {strip.protects(), tolerance, number, check});
}

}  // namespace fluidcarve
