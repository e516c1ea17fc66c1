#include "carve/seam/joins.h"

#include "carve/seam/column_cell.h"

#include <tbb/parallel_for.h>

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
    : axis_(steps.front()->axis()),
      lateral_axis_(steps.front()->lateral_axis()),
      slice_axis_(steps.front()->slice_axis()),
      laterals_(steps.front()->laterals()),
      slices_(steps.front()->slices()),
      first_lateral_(steps.front()->first_lateral()),
      first_slice_(steps.front()->first_slice()),
      shift_(steps.front()->origin() - steps.front()->start()),
      inserts_(steps.front()->inserts()),
      paired_(steps.front()->paired()),
      closed_(steps.front()->closed()),
      around_(steps.front()->around()),
      seams_(steps.front()->first_displaced(first_lateral_, first_slice_).size()),
      fade_(fade),
      windows_(windows.begin(), windows.end()),
      places_(seams_ * static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(slices_)) {
    const auto laterals = static_cast<std::size_t>(laterals_), row = laterals * seams_;
    const int reach = static_cast<int>(steps.size() / 2);
    float all = 0;
    for (int n = -reach; n <= reach; ++n) all += static_cast<float>(reach + 1 - std::abs(n));
    tbb::parallel_for(
        tbb::blocked_range<int>(0, slices_), [&](const tbb::blocked_range<int>& range) {
            for (int k = range.begin(); k < range.end(); ++k)
                for (int lateral = 0; lateral < laterals_; ++lateral) {
                    auto* const to = places_.data() + static_cast<std::size_t>(k) * row +
                                     static_cast<std::size_t>(lateral) * seams_;
                    for (int n = -reach; n <= reach; ++n) {
                        const int frame = n + reach;
                        const auto bounds = steps[static_cast<std::size_t>(frame)]->first_displaced(
                            first_lateral_ + lateral, first_slice_ + k);
                        const float weight = static_cast<float>(reach + 1 - std::abs(n)) / all;
                        for (std::size_t seam = 0; seam < seams_; ++seam)
                            to[seam] += weight * (static_cast<float>(bounds[seam]) - 0.5f);
                    }
                }
        });
    smooth(laterals_, seams_, slices_, row, around_);
    smooth(slices_, row, laterals_, seams_, closed_);
}

void Joins::smooth(int count, std::size_t stride, int lines, std::size_t between, bool ring) {
    if (count == 1) return;
    tbb::parallel_for(tbb::blocked_range<int>(0, lines), [&](const tbb::blocked_range<int>& range) {
        std::vector<float> copy(static_cast<std::size_t>(count) * seams_);
        for (int line = range.begin(); line < range.end(); ++line) {
            auto* const first = places_.data() + static_cast<std::size_t>(line) * between;
            for (std::size_t n = 0; n < static_cast<std::size_t>(count); ++n)
                std::copy_n(first + n * stride, seams_, copy.data() + n * seams_);
            for (int at = 0; at < count; ++at) {
                auto* const to = first + static_cast<std::size_t>(at) * stride;
                std::fill_n(to, seams_, 0.0f);
                for (int n = 0; n < static_cast<int>(tent.size()); ++n) {
                    const int near = at + n - static_cast<int>(tent.size() / 2),
                              clamped = ring ? (near % count + count) % count
                                             : std::clamp(near, 0, count - 1);
                    const auto* const from =
                        copy.data() + static_cast<std::size_t>(clamped) * seams_;
                    for (std::size_t seam = 0; seam < seams_; ++seam)
                        to[seam] += tent[static_cast<std::size_t>(n)] * from[seam];
                }
            }
        }
    });
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
    for (int k = first[2] - first_slice_; k < first[2] - first_slice_ + size[2]; ++k)
        for (int j = first[1] - first_lateral_; j < first[1] - first_lateral_ + size[1]; ++j) {
            const auto* const places = column(around_ ? j % laterals_ : std::min(j, laterals_ - 1),
                                              closed_ ? k % slices_ : std::min(k, slices_ - 1));
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
    const double u = at[axis_], lateral = at[lateral_axis_] - first_lateral_,
                 slice = at[slice_axis_] - first_slice_;
    const auto [j, k, next_j, next_k] =
        column_cell(lateral, slice, laterals_, slices_, around_, closed_);
    const PlacesBetween place(
        {column(j, k), column(next_j, k), column(j, next_k), column(next_j, next_k)},
        std::clamp(lateral - j, 0.0, 1.0), std::clamp(slice - k, 0.0, 1.0));
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
                     place = at[axis_] - scale * by;
        auto there = at;
        there[axis_] = place;
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
