#include "carve/seam/joins.h"

#include "carve/base/each_in_parallel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fluidcarve {

namespace {

/// Weights of the mean over neighbouring columns, and over frames.
constexpr std::array<float, 5> tent{1 / 9.0f, 2 / 9.0f, 3 / 9.0f, 2 / 9.0f, 1 / 9.0f};

/// Rises smoothly from 0 to 1.
double rise(double x) {
    const double part = std::clamp(x, 0.0, 1.0);
    return part * part * (3 - 2 * part);
}

/// Where seams are between four columns.
class PlacesBetween {
public:
    /// @param b, c  from the first column to the next laterally, and to the next slice
    PlacesBetween(const std::array<const float*, 4>& columns, double b, double c)
        : columns_(columns), b_(b), c_(c) {}

    double operator()(std::size_t n) const {
        if (b_ == 0 && c_ == 0) return static_cast<double>(columns_[0][n]);
        const double low = columns_[0][n] + b_ * (columns_[1][n] - columns_[0][n]),
                     high = columns_[2][n] + b_ * (columns_[3][n] - columns_[2][n]);
        return low + c_ * (high - low);
    }
    /// The first seam above a place.
    std::size_t first_above(double at, std::size_t seams) const {
        std::size_t first = 0;
        for (auto left = seams; left > 0;) {
            const auto half = left / 2;
            if ((*this)(first + half) > at) {
                left = half;
            } else {
                first += half + 1;
                left -= half + 1;
            }
        }
        return first;
    }

private:
    const std::array<const float*, 4> columns_;
    const double b_, c_;
};

}  // namespace

Joins::Joins(std::span<const CarveStep* const> steps, std::span<const CarveStep::Span> windows,
             double fade)
    : columns_(steps.front()->columns()),
      shift_(steps.front()->origin() - steps.front()->start()),
      inserts_(steps.front()->inserts()),
      paired_(steps.front()->paired()),
      seams_(steps.front()->first_displaced(std::size_t{0}).size()),
      fade_(fade),
      windows_(windows.begin(), windows.end()),
      places_(seams_ * columns_.count()) {
    const auto in_time = [&steps](std::size_t n) {
        return static_cast<float>(std::min(n + 1, steps.size() - n));
    };
    float all = 0;
    for (std::size_t n = 0; n < steps.size(); ++n) all += in_time(n);
    each_in_parallel(columns_.count(), 64, [&](std::size_t column) {
        auto* const to = places_.data() + column * seams_;
        for (std::size_t n = 0; n < steps.size(); ++n) {
            const auto bounds = steps[n]->first_displaced(column);
            const float weight = in_time(n) / all;
            for (std::size_t seam = 0; seam < seams_; ++seam)
                to[seam] += weight * (static_cast<float>(bounds[seam]) - 0.5f);
        }
    });
    const auto mean = [this](const float* const* rows, float* to) {
        std::fill_n(to, seams_, 0.0f);
        for (std::size_t n = 0; n < tent.size(); ++n)
            for (std::size_t seam = 0; seam < seams_; ++seam) to[seam] += tent[n] * rows[n][seam];
    };
    columns_.average(places_.data(), seams_, tent.size(), mean);
}

double Joins::displacement(std::size_t passed) const {
    const auto one = paired_ ? seams_ / 2 : seams_;
    const auto ahead = static_cast<int>(std::min(passed, one)),
               back = static_cast<int>(passed - std::min(passed, one));
    return (inserts_ ? -1 : 1) * (ahead - back) + shift_;
}

std::array<double, 2> Joins::range(const std::array<int, 3>& first,
                                   const std::array<int, 3>& size) const {
    std::array<double, 2> out{displacement(seams_), displacement(seams_)};
    bool any = false;
    for (int slice = first[2]; slice < first[2] + size[2]; ++slice)
        for (int lateral = first[1]; lateral < first[1] + size[1]; ++lateral) {
            const auto* const places = column(columns_.index_within(lateral, slice));
            const auto passed = [&](double entry) {
                return static_cast<std::size_t>(std::upper_bound(places, places + seams_, entry) -
                                                places);
            };
            const auto last = passed(first[0] + size[0] + fade_ / 2);
            for (auto n = passed(first[0] - fade_ / 2); n <= last; ++n) {
                const double d = displacement(n);
                out = any ? std::array{std::min(out[0], d), std::max(out[1], d)} : std::array{d, d};
                any = true;
            }
        }
    return out;
}

void Joins::sides(const openvdb::Vec3d& at, std::vector<Side>& to) const {
    to.clear();
    const double u = at[columns_.axis()];
    const auto [columns, lateral, slice] = columns_.cell(at);
    const PlacesBetween place(
        {column(columns[0]), column(columns[1]), column(columns[2]), column(columns[3])},
        std::clamp(lateral, 0.0, 1.0), std::clamp(slice, 0.0, 1.0));
    // Joins far below the point show no content from before them.
    const auto first = place.first_above(u - fade_ / 2, seams_);
    const auto one = paired_ ? seams_ / 2 : seams_;
    double shown = 1;  // share of the content behind the joins passed so far
    for (auto n = first; n < seams_; ++n) {
        const double from = place(n);
        double behind = 0;
        if (from < u + fade_ / 2) {
            const auto& window = windows_[n < one ? 0 : windows_.size() - 1].entries;
            // A fade stays in its window: content beyond keeps its place.
            const double width = std::min(
                {fade_, 2 * (from - (window.first - 0.5)), 2 * (window.last + 0.5 - from)});
            behind = std::min(shown, width > 1e-3 ? rise((u - from) / width + 0.5)
                                     : u > from   ? 1.0
                                                  : 0.0);
        }
        if (shown > behind) to.push_back({displacement(n), shown - behind});
        shown = behind;
        if (shown == 0) return;
    }
    to.push_back({displacement(seams_), shown});
}

void Joins::places(const CarveStep& step, const openvdb::Vec3d& at, double share,
                   std::vector<double>& to) const {
    to.clear();
    std::vector<Side> shown;
    for (std::size_t passed = 0; passed <= seams_; ++passed) {
        const double scale = step.rim_scale(at), by = displacement(passed),
                     place = at[step.axis()] - scale * by;
        auto there = at;
        there[step.axis()] = place;
        if (!step.holds(there) || !step.carves(there, scale)) continue;
        sides(there, shown);
        // Shares are dealt out from the last side to the first.
        double left = 1;
        for (const auto& side : shown) {
            left -= side.weight;
            if (share < left && &side != &shown.back()) continue;
            if (side.by == by && (to.empty() || to.back() != place)) to.push_back(place);
            break;
        }
    }
}

}  // namespace fluidcarve
