#include "carve/seam/smooth_displacement.h"

#include "carve/seam/joins.h"
#include "carve/simd/eight.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

/// Displacements this close to a whole number of vertices are rounded to it.
constexpr float snap = 1e-4f;

/// Weights of a tent from -n to n; their sum is 1.
std::vector<float> tent(double reach) {
    const int n = static_cast<int>(std::ceil(reach));
    std::vector<double> out;
    double sum = 0;
    for (int x = -n; x <= n; ++x) sum += out.emplace_back(1 - std::abs(x) / (reach + 1));
    for (auto& weight : out) weight /= sum;
    return {out.begin(), out.end()};
}

/// Computes the weighted mean of rows, and rounds it where a whole number is near. The mean of
/// equal values is that value, bit for bit.
/// @param weights  an odd number; their sum is 1
/// @param rows     one for each weight: whole_eights(size) floats
/// @param to       whole_eights(size) floats; not part of a row
FLUIDCARVE_WIDE void weighted_mean(std::span<const float> weights, const float* const* rows,
                                   std::size_t size, float* to) {
    const auto middle = weights.size() / 2;
    for (std::size_t e = 0; e < size; e += 8) {
        const auto base = eight_at(rows[middle] + e);
        Eight sum{};
        for (std::size_t n = 0; n < weights.size(); ++n)
            if (n != middle) sum += weights[n] * (eight_at(rows[n] + e) - base);
        const auto mean = base + sum;
        // Adding this number, 1.5 * 2^23, leaves no bits for a fraction.
        constexpr float whole_only = 12582912;
        const auto whole = (mean + whole_only) - whole_only,
                   out = absolute(mean - whole) < snap ? whole : mean;
        std::memcpy(to + e, &out, sizeof out);
    }
}

/// Writes a column's displacements without smoothing.
/// @param to  `[entry]`, entries of the range, vertices; up to seven more are overwritten
FLUIDCARVE_WIDE void write_displacements(const CarveStep& step,
                                         std::span<const std::uint16_t> bounds,
                                         const Window& entries, float* to) {
    for (int e = entries.first; e <= entries.last;) {
        const auto passed = CarveStep::passed(e, bounds);
        const float d = 0.5f * static_cast<float>(step.displacement(e, passed, bounds));
        // Displacements change at bounds. At the bound itself, a new entry has one of its own.
        const bool at_bound = passed > 0 && bounds[passed - 1] == e;
        const int end = at_bound                 ? e + 1
                        : passed < bounds.size() ? std::min<int>(bounds[passed], entries.last + 1)
                                                 : entries.last + 1;
        const auto eight = eight_of(d);
        for (int at = e; at < end; at += 8)
            std::memcpy(to + (at - entries.first), &eight, sizeof eight);
        e = end;
    }
}

/// Displacements of one column, mirrored at the ends of a span.
class Mirrored {
public:
    Mirrored(std::span<const float> all, int first) : all_(all), first_(first) {}
    float operator()(int entry, const CarveStep::Span& span) const {
        double add = 0, sign = 1;
        const auto& [low, high] = span.entries;
        while (entry < low || entry > high) {
            const bool below = entry < low;
            add += sign * 2 * (below ? span.before : span.behind);
            sign = -sign;
            entry = (below ? 2 * low - 1 : 2 * high + 1) - entry;
        }
        return static_cast<float>(add + sign * all_[static_cast<std::size_t>(entry - first_)]);
    }

private:
    std::span<const float> all_;
    int first_;
};

/// The spans, without entries at their ends that smoothing leaves as they are. Before the lowest
/// bound of all steps, and behind the highest one, all entries are displaced alike. Smoothing mixes
/// different displacements only where a bound is within its reach.
/// @param reach  of the smoothing along the axis, entries
std::vector<CarveStep::Span> where_smoothed(std::span<const CarveStep* const> steps,
                                            std::span<const CarveStep::Span> spans, int reach) {
    int front = spans.back().entries.last, back = spans.front().entries.first;
    for (const auto* const step : steps)
        for (std::size_t column = 0; column < step->columns().count(); ++column) {
            const auto bounds = step->first_displaced(column);
            front = std::min<int>(front, bounds.front());
            back = std::max<int>(back, bounds.back());
        }
    std::vector<CarveStep::Span> out(spans.begin(), spans.end());
    auto &first = out.front().entries.first, &last = out.back().entries.last;
    first = std::max(first, front - reach - 1);
    last = std::min(last, back + reach + 1);
    return out;
}

/// Smooths columns over frames and along the axis, one after the other.
class SoftColumns {
public:
    /// @param steps        in the frames
    /// @param along, over  weights along the axis, and over the frames
    SoftColumns(std::span<const CarveStep* const> steps, std::span<const CarveStep::Span> spans,
                std::span<const float> along, std::span<const float> over)
        : steps_(steps),
          spans_(spans),
          along_(along),
          over_(over),
          reach_(static_cast<int>(along.size() / 2)),
          first_(spans.front().entries.first),
          last_(spans.back().entries.last),
          size_(static_cast<std::size_t>(last_ - first_) + 3),
          row_(whole_eights(size_ + 7)),
          frames_(row_ * steps.size()),
          mean_(row_),
          beyond_(row_ + along.size()),
          smoothed_(row_) {
        for (std::size_t n = 0; n < steps.size(); ++n)
            of_frames_.push_back(frames_.data() + n * row_);
        for (std::size_t n = 0; n < along.size(); ++n) shifted_.push_back(beyond_.data() + n);
    }

    /// @param to  from the entry before the first span to the one behind the last
    void write(std::size_t column, float* to) {
        for (std::size_t n = 0; n < steps_.size(); ++n)
            write_displacements(*steps_[n], steps_[n]->first_displaced(column), {first_, last_},
                                frames_.data() + n * row_ + 1);
        if (steps_.size() > 1) weighted_mean(over_, of_frames_.data(), size_, mean_.data());
        auto& now = steps_.size() == 1 ? frames_ : mean_;
        now.front() = static_cast<float>(spans_.front().before);
        now[size_ - 1] = static_cast<float>(spans_.back().behind);
        std::copy_n(now.data(), size_, to);
        for (const auto& span : spans_) smooth(now, span, to);
    }

private:
    void smooth(const std::vector<float>& now, const CarveStep::Span& span, float* to) {
        const Mirrored mirrored(now, first_ - 1);
        const auto& [from, last] = span.entries;
        const int low = from - reach_;
        const auto length = static_cast<std::size_t>(last - from) + 1,
                   place = static_cast<std::size_t>(from - first_) + 1;
        for (int e = low; e < from; ++e)
            beyond_[static_cast<std::size_t>(e - low)] = mirrored(e, span);
        std::copy_n(now.data() + place, length, beyond_.data() + reach_);
        for (int e = last + 1; e <= last + reach_; ++e)
            beyond_[static_cast<std::size_t>(e - low)] = mirrored(e, span);
        weighted_mean(along_, shifted_.data(), length, smoothed_.data());
        std::copy_n(smoothed_.data(), length, to + place);
    }

    const std::span<const CarveStep* const> steps_;
    const std::span<const CarveStep::Span> spans_;
    const std::span<const float> along_, over_;
    const int reach_, first_, last_;
    const std::size_t size_, row_;
    /// Rows of displacements: in the frames, over time, with what lies beyond a span, smoothed.
    std::vector<float> frames_, mean_, beyond_, smoothed_;
    std::vector<const float*> of_frames_, shifted_;
};

}  // namespace

SmoothDisplacement::SmoothDisplacement(const CarveStep& step, int first, int last)
    : columns_(step.columns()), carved_{step.start(), step.last()}, first_(first) {
    resize(last);
}

void SmoothDisplacement::resize(int last) {
    last_ = last;
    row_ = whole_eights(static_cast<std::size_t>(last_ - first_) + 1);
    entries_ = std::make_shared<FloatFrameStore>(1, row_ * columns_.count());
}

SmoothDisplacement::SmoothDisplacement(const CarveStep& step) : SmoothDisplacement(step, 0, 0) {
    const int reach = step.count();
    first_ = std::clamp(step.first_moved() - 1 - reach, step.start(), step.last());
    int last = first_;
    for (std::size_t column = 0; column < columns_.count(); ++column)
        last =
            std::max(last, std::min(step.first_displaced(column).back() + reach + 1, step.last()));
    resize(last);

    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, columns_.count(), 64),
        [&](const tbb::blocked_range<std::size_t>& range) {
            // Running sums of displacements, half vertices: over all entries before one, from the
            // first that counts.
            const int from = std::max(first_ - reach, step.start()),
                      to = std::min(last_ + reach, step.last());
            std::vector<int> before(static_cast<std::size_t>(to - from) + 2);
            const auto sum = [&](int entry) {
                return before[static_cast<std::size_t>(entry - from)];
            };
            for (auto column = range.begin(); column < range.end(); ++column) {
                const auto bounds = step.first_displaced(column);
                std::size_t passed = CarveStep::passed(from, bounds);
                for (int e = from; e <= to; ++e) {
                    while (passed < bounds.size() && bounds[passed] <= e) ++passed;
                    before[static_cast<std::size_t>(e - from) + 1] =
                        sum(e) + step.displacement(e, passed, bounds);
                }
                for (int e = first_; e <= last_; ++e) {
                    const int beside = std::min({reach, e - step.start(), step.last() - e});
                    entries()[column * row_ + static_cast<std::size_t>(e - first_)] =
                        static_cast<float>(0.5 * (sum(e + beside + 1) - sum(e - beside)) /
                                           (2 * beside + 1));
                }
            }
        });
}

SmoothDisplacement SmoothDisplacement::soft(std::span<const CarveStep* const> steps,
                                            std::span<const CarveStep::Span> windows,
                                            const Softness& softness) {
    const auto& step = *steps[steps.size() / 2];
    const auto along = tent(softness.vertices), over = tent(softness.frames);
    const int reach = static_cast<int>(along.size() / 2);
    const auto spans = where_smoothed(steps, windows, reach);
    SmoothDisplacement out(step, spans.front().entries.first - 1, spans.back().entries.last + 1);
    out.ends_ = {spans.front().before, spans.back().behind};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.columns_.count(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          SoftColumns columns(steps, spans, along, over);
                          for (auto column = range.begin(); column < range.end(); ++column)
                              columns.write(column, out.entries() + column * out.row_);
                      });
    if (reach > 0) {
        const auto across = tent(softness.across.value_or(softness.vertices));
        const auto mean = [&](const float* const* rows, float* to) {
            weighted_mean(across, rows, out.row_, to);
        };
        out.columns_.average(out.entries(), out.row_, across.size(), mean);
    }
    return out;
}

SmoothDisplacement SmoothDisplacement::of(const CarveStep& step, const Warp& warp, std::size_t t) {
    SmoothDisplacement out(step, step.start(), step.last());
    const auto laterals = static_cast<std::size_t>(out.columns_.laterals);
    const int vertices = step.before();
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, out.columns_.count(), 64),
        [&](const tbb::blocked_range<std::size_t>& range) {
            std::vector<float> shifts(static_cast<std::size_t>(vertices));
            for (auto column = range.begin(); column < range.end(); ++column) {
                warp.column(t, static_cast<int>(column % laterals),
                            static_cast<int>(column / laterals), shifts);
                const auto shift = [&](int vertex) {
                    return static_cast<double>(
                        shifts[static_cast<std::size_t>(std::min(vertex, vertices - 1))]);
                };
                // The content of an entry comes from between vertex `low` and the next.
                int low = 0;
                for (int e = out.first_; e <= out.last_; ++e) {
                    const int to = e - step.origin();
                    while (low + 2 < vertices && low + 1 + shift(low + 1) <= to) ++low;
                    const double change = shift(low + 1) - shift(low),
                                 part = (to - low - shift(low)) / (1 + change);
                    // Subtracted from 0, so that no displacement is -0.
                    const double d = 0 - (shift(low) + part * change), whole = std::round(d);
                    out.entries()[column * out.row_ + static_cast<std::size_t>(e - out.first_)] =
                        static_cast<float>(std::abs(d - whole) < snap ? whole : d);
                }
            }
        });
    return out;
}

SmoothDisplacement::Value SmoothDisplacement::at(const Vec3d& at, const CarveStep& step) const {
    std::array<int, 3> low;
    std::array<double, 3> part;
    for (std::size_t d = 0; d < 3; ++d) {
        low[d] = static_cast<int>(at[columns_.axes[d]]);
        part[d] = at[columns_.axes[d]] - low[d];
    }
    Value out{0, Vec3d(0)};
    if (low[0] + 2 < first_ && column(std::size_t{0}).front() == 0) return out;

    const std::array<int, 3> first{carved_.first, columns_.first_lateral, columns_.first_slice},
        last{carved_.last, columns_.last_lateral(), columns_.last_slice()};
    const auto value = [&](std::array<int, 3> vertex) {
        vertex[1] = columns_.turned_lateral(vertex[1]);
        vertex[2] = columns_.turned_slice(vertex[2]);
        const auto d = [&] {
            const double here =
                entry(std::clamp(vertex[0], carved_.first, carved_.last), vertex[1], vertex[2]);
            if (!ends_ || (vertex[0] >= carved_.first && vertex[0] <= carved_.last)) return here;
            return 2 * (vertex[0] < carved_.first ? ends_->first : ends_->second) - here;
        };
        if (!step.rims_fade()) return d();
        Vec3d place;
        for (std::size_t n = 0; n < 3; ++n) place[columns_.axes[n]] = vertex[n];
        return step.rim_scale(place) * d();
    };
    for (unsigned n = 0; n < 8; ++n) {
        double weight = 1;
        auto corner = low;
        for (std::size_t d = 0; d < 3; ++d) {
            corner[d] += n >> d & 1 ? 1 : 0;
            weight *= n >> d & 1 ? part[d] : 1 - part[d];
        }
        if (weight == 0) continue;
        out.d += weight * value(corner);
        for (std::size_t d = 0; d < 3; ++d) {
            auto below = corner, above = corner;
            --below[d];
            ++above[d];
            // At an end of a mirrored map, the mirror image gives the slope. Otherwise slopes are
            // one-sided at rims.
            if (d == 0 ? !ends_ : d == 1 ? !columns_.around : !columns_.closed) {
                below[d] = std::max(below[d], first[d]);
                above[d] = std::min(above[d], last[d]);
            }
            if (below[d] == above[d]) continue;
            out.gradient[columns_.axes[d]] +=
                weight * (value(above) - value(below)) / (above[d] - below[d]);
        }
    }
    return out;
}

void soften(CarveStep& step, const Seams& seams, std::size_t t, const Softness& softness) {
    const int reach = static_cast<int>(std::ceil(softness.frames)),
              last = static_cast<int>(seams.frames.size()) - 1;
    std::vector<CarveStep> others;
    others.reserve(2 * static_cast<std::size_t>(reach));
    std::vector<const CarveStep*> steps;
    std::array<int, 3> origin{};
    origin[static_cast<std::size_t>(step.axis())] = step.origin();
    origin[static_cast<std::size_t>(step.lateral_axis())] = step.columns().first_lateral;
    origin[static_cast<std::size_t>(step.slice_axis())] = step.columns().first_slice;
    for (int n = -reach; n <= reach; ++n) {
        const int near = std::clamp(static_cast<int>(t) + n, 0, last);
        if (near == static_cast<int>(t)) steps.push_back(&step);
        else
            steps.push_back(&others.emplace_back(seams, static_cast<std::size_t>(near),
                                                 static_cast<std::size_t>(step.count()), origin));
    }
    auto soft = std::make_shared<const SmoothDisplacement>(
        SmoothDisplacement::soft(steps, step.windows(seams), softness));
    const int first = soft->first(), behind = soft->last();
    step.set_soft(std::move(soft), first, behind);
    if (softness.fade > 0)
        step.set_joins(std::make_shared<const Joins>(steps, step.windows(seams), softness.fade));
}

}  // namespace fluidcarve
