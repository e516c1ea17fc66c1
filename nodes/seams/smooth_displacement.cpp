#include "nodes/seams/smooth_displacement.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

/// Displacements this close to a whole number of vertices are rounded to it.
constexpr float snap = 1e-4f;

/// Weights of a tent from -n to n; their sum is 1.
std::vector<double> tent(double reach) {
    const int n = static_cast<int>(std::ceil(reach));
    std::vector<double> out;
    double sum = 0;
    for (int x = -n; x <= n; ++x) sum += out.emplace_back(1 - std::abs(x) / (reach + 1));
    for (auto& weight : out) weight /= sum;
    return out;
}

/// Displacements of one column, mirrored at the ends of a span.
class Mirrored {
public:
    Mirrored(std::span<const double> all, int first) : all_(all), first_(first) {}
    double operator()(int entry, const CarveStep::Span& span) const {
        double add = 0, sign = 1;
        const auto& [low, high] = span.entries;
        while (entry < low || entry > high) {
            const bool below = entry < low;
            add += sign * 2 * (below ? span.before : span.behind);
            sign = -sign;
            entry = (below ? 2 * low - 1 : 2 * high + 1) - entry;
        }
        return add + sign * all_[static_cast<std::size_t>(entry - first_)];
    }

private:
    std::span<const double> all_;
    int first_;
};

}  // namespace

SmoothDisplacement::SmoothDisplacement(const CarveStep& step, int first, int last)
    : axis_(step.axis()),
      laterals_(step.laterals()),
      slices_(step.slices()),
      first_lateral_(step.first_lateral()),
      closed_(step.closed()),
      carved_{step.start(), step.last()},
      first_(first),
      last_(last),
      entries_((static_cast<std::size_t>(last - first) + 1) * static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(slices_)) {}

SmoothDisplacement::SmoothDisplacement(const CarveStep& step) : SmoothDisplacement(step, 0, 0) {
    const int reach = step.count();
    first_ = std::clamp(step.first_moved() - 1 - reach, step.start(), step.last());
    last_ = first_;
    for (int k = 0; k < slices_; ++k)
        for (int lateral = step.first_lateral(); lateral <= step.last_lateral(); ++lateral)
            last_ = std::max(last_, std::min(step.bounds(lateral, k).back() + reach + 1, step.last()));

    const auto size = static_cast<std::size_t>(last_ - first_) + 1, laterals = static_cast<std::size_t>(laterals_);
    entries_.resize(size * laterals * static_cast<std::size_t>(slices_));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, laterals * static_cast<std::size_t>(slices_), 64), [&](const tbb::blocked_range<std::size_t>& range) {
        // Running sums of displacements, half vertices: over all entries before one, from the first that counts.
        const int from = std::max(first_ - reach, step.start()), to = std::min(last_ + reach, step.last());
        std::vector<int> before(static_cast<std::size_t>(to - from) + 2);
        const auto sum = [&](int entry) { return before[static_cast<std::size_t>(entry - from)]; };
        for (auto column = range.begin(); column < range.end(); ++column) {
            const int lateral = step.first_lateral() + static_cast<int>(column % laterals), k = static_cast<int>(column / laterals);
            const auto bounds = step.bounds(lateral, k);
            std::size_t passed = CarveStep::passed(from, bounds);
            for (int e = from; e <= to; ++e) {
                while (passed < bounds.size() && bounds[passed] <= e) ++passed;
                before[static_cast<std::size_t>(e - from) + 1] = sum(e) + step.displacement(e, passed, bounds);
            }
            for (int e = first_; e <= last_; ++e) {
                const int beside = std::min({reach, e - step.start(), step.last() - e});
                entries_[column * size + static_cast<std::size_t>(e - first_)] =
                    static_cast<float>(0.5 * (sum(e + beside + 1) - sum(e - beside)) / (2 * beside + 1));
            }
        }
    });
}

SmoothDisplacement SmoothDisplacement::soft(std::span<const CarveStep* const> steps, std::span<const CarveStep::Span> spans, const Softness& softness) {
    const auto& step = *steps[steps.size() / 2];
    const auto along = tent(softness.vertices), over = tent(softness.frames);
    const int reach = static_cast<int>(along.size() / 2), first = spans.front().entries.first, last = spans.back().entries.last;
    SmoothDisplacement out(step, first - 1, last + 1);
    out.ends_ = {spans.front().before, spans.back().behind};
    const auto size = static_cast<std::size_t>(last - first) + 3, laterals = static_cast<std::size_t>(out.laterals_);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, laterals * static_cast<std::size_t>(out.slices_), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          std::vector<double> now(size);
                          for (auto column = range.begin(); column < range.end(); ++column) {
                              const int lateral = step.first_lateral() + static_cast<int>(column % laterals), k = static_cast<int>(column / laterals);
                              std::ranges::fill(now, 0.0);
                              for (std::size_t n = 0; n < steps.size(); ++n) {
                                  const auto bounds = steps[n]->bounds(lateral, k);
                                  std::size_t passed = 0;
                                  for (int e = first; e <= last; ++e) {
                                      while (passed < bounds.size() && bounds[passed] <= e) ++passed;
                                      now[static_cast<std::size_t>(e - first) + 1] += 0.5 * over[n] * steps[n]->displacement(e, passed, bounds);
                                  }
                              }
                              now.front() = out.ends_->first;
                              now.back() = out.ends_->second;
                              auto* const to = out.entries_.data() + column * size;
                              std::ranges::transform(now, to, [](double d) { return static_cast<float>(d); });
                              const Mirrored mirrored(now, first - 1);
                              for (const auto& span : spans)
                                  for (int e = span.entries.first; e <= span.entries.last; ++e) {
                                      double sum = 0;
                                      for (std::size_t n = 0; n < along.size(); ++n) sum += along[n] * mirrored(e + static_cast<int>(n) - reach, span);
                                      to[e - first + 1] = static_cast<float>(sum);
                                  }
                          }
                      });
    if (reach > 0) {
        out.smooth_across(along, false);
        out.smooth_across(along, true);
    }
    for (auto& d : out.entries_)
        if (std::abs(d - std::round(d)) < snap) d = std::round(d);
    return out;
}

void SmoothDisplacement::smooth_across(std::span<const double> weights, bool along_w) {
    const int reach = static_cast<int>(weights.size() / 2), count = along_w ? slices_ : laterals_;
    if (count == 1) return;
    const auto size = static_cast<std::size_t>(last_ - first_) + 1;
    const auto from = entries_;
    const auto place = [&](int lateral, int k) {
        return (static_cast<std::size_t>(lateral) + static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(k)) * size;
    };
    tbb::parallel_for(0, slices_, [&](int k) {
        for (int lateral = 0; lateral < laterals_; ++lateral) {
            auto* const to = entries_.data() + place(lateral, k);
            std::fill_n(to, size, 0.0f);
            for (std::size_t n = 0; n < weights.size(); ++n) {
                int near = (along_w ? k : lateral) + static_cast<int>(n) - reach;
                near = along_w && closed_ ? ((near % count) + count) % count : std::clamp(near, 0, count - 1);
                const auto* const other = from.data() + (along_w ? place(lateral, near) : place(near, k));
                const auto weight = static_cast<float>(weights[n]);
                for (std::size_t e = 0; e < size; ++e) to[e] += weight * other[e];
            }
        }
    });
}

SmoothDisplacement::Value SmoothDisplacement::at(const Vec3d& at, const CarveStep& step) const {
    const std::array<int, 3> axes{axis_, 1 - axis_, 2};
    std::array<int, 3> low;
    std::array<double, 3> part;
    for (std::size_t d = 0; d < 3; ++d) {
        low[d] = static_cast<int>(at[axes[d]]);
        part[d] = at[axes[d]] - low[d];
    }
    Value out{0, Vec3d(0)};
    if (low[0] + 2 < first_ && column(first_lateral_, 0).front() == 0) return out;

    const std::array<int, 3> first{carved_.first, first_lateral_, 0}, last{carved_.last, first_lateral_ + laterals_ - 1, slices_ - 1};
    const auto value = [&](std::array<int, 3> vertex) {
        if (closed_) vertex[2] = (vertex[2] + slices_) % slices_;
        const auto d = [&] {
            const double here = entry(std::clamp(vertex[0], carved_.first, carved_.last), vertex[1], vertex[2]);
            if (!ends_ || (vertex[0] >= carved_.first && vertex[0] <= carved_.last)) return here;
            return 2 * (vertex[0] < carved_.first ? ends_->first : ends_->second) - here;
        };
        if (!step.fades()) return d();
        Vec3d place;
        for (std::size_t n = 0; n < 3; ++n) place[axes[n]] = vertex[n];
        return step.scale(place) * d();
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
            // At an end of a mirrored map, the mirror image gives the slope. Otherwise slopes are one-sided at rims.
            if (d == 0 ? !ends_ : d == 1 || !closed_) {
                below[d] = std::max(below[d], first[d]);
                above[d] = std::min(above[d], last[d]);
            }
            if (below[d] == above[d]) continue;
            out.gradient[axes[d]] += weight * (value(above) - value(below)) / (above[d] - below[d]);
        }
    }
    return out;
}

void soften(CarveStep& step, const Seams& seams, std::size_t t, const Softness& softness) {
    const int reach = static_cast<int>(std::ceil(softness.frames)), last = static_cast<int>(seams.frames.size()) - 1;
    std::vector<CarveStep> others;
    others.reserve(2 * static_cast<std::size_t>(reach));
    std::vector<const CarveStep*> steps;
    std::array<int, 2> origin{};
    origin[static_cast<std::size_t>(step.axis())] = step.origin();
    origin[static_cast<std::size_t>(step.lateral_axis())] = step.first_lateral();
    for (int n = -reach; n <= reach; ++n) {
        const int near = std::clamp(static_cast<int>(t) + n, 0, last);
        if (near == static_cast<int>(t)) steps.push_back(&step);
        else steps.push_back(&others.emplace_back(seams, static_cast<std::size_t>(near), static_cast<std::size_t>(step.count()), origin));
    }
    auto soft = std::make_shared<const SmoothDisplacement>(SmoothDisplacement::soft(steps, step.windows(seams), softness));
    const int first = soft->first(), behind = soft->last();
    step.set_soft(std::move(soft), first, behind);
}

}  // namespace fluidcarve
