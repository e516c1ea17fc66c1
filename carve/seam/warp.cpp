#include "carve/seam/warp.h"

#include "carve/base/each_in_parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>

namespace fluidcarve {

namespace {

std::size_t product(const std::array<int, 3>& counts) {
    return static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
           static_cast<std::size_t>(counts[2]);
}

/// The points on both sides of a vertex.
struct PointsAround {
    std::size_t low, high;
    float weight;  ///< of the high one
};

PointsAround points_around(int vertex, int vertices, int points, int factor, bool ring) {
    const int low = std::min(vertex / factor, points - 1), high = low + 1 < points ? low + 1
                                                                  : ring           ? 0
                                                                                   : low;
    const int from = std::min(low * factor, vertices - 1),
              to = ring && high == 0 ? vertices : std::min(high * factor, vertices - 1);
    const auto weight =
        to > from ? static_cast<float>(vertex - from) / static_cast<float>(to - from) : 0;
    return {static_cast<std::size_t>(low), static_cast<std::size_t>(high), weight};
}

float mix(float low, float high, float weight) {
    return weight == 0 ? low : low + weight * (high - low);
}

Warp::Range around(const Warp::Range& a, const Warp::Range& b) {
    return {std::min(a.least, b.least), std::max(a.most, b.most)};
}

}  // namespace

Warp::Warp(const std::array<int, 3>& vertices, const Rings& rings, int factor, std::size_t frames,
           const Limits& limits)
    : vertices_(vertices),
      points_(points_of(vertices, rings, factor)),
      rings_(rings),
      factor_(factor),
      values_(std::make_shared<FloatFrameStore>(frames, product(points_), limits)) {}

std::array<int, 3> Warp::points_of(const std::array<int, 3>& vertices, const Rings& rings,
                                   int factor) {
    const auto along = [factor](int size, bool ring) {
        return ring ? (size + factor - 1) / factor : (size + factor - 2) / factor + 1;
    };
    return {along(vertices[0], false), along(vertices[1], rings.lateral),
            along(vertices[2], rings.w)};
}

std::span<float> Warp::values(std::size_t t) { return values_->entries(std::min(t, frames() - 1)); }

std::span<const float> Warp::values(std::size_t t) const {
    return std::as_const(*values_).entries(std::min(t, frames() - 1));
}

template <class Use>
void Warp::with_column(std::size_t t, int lateral, int k, const Use& use) const {
    const auto all = values(t);
    const auto row = static_cast<std::size_t>(points_[0]);
    const auto a = points_around(lateral, vertices_[1], points_[1], factor_, rings_.lateral),
               b = points_around(k, vertices_[2], points_[2], factor_, rings_.w);
    const auto from = [&](std::size_t j, std::size_t n) {
        return all.data() + (n * static_cast<std::size_t>(points_[1]) + j) * row;
    };
    const std::array rows{from(a.low, b.low), from(a.high, b.low), from(a.low, b.high),
                          from(a.high, b.high)};
    const auto scale = static_cast<float>(scale_);
    use([&](std::size_t point) {
        return scale * mix(mix(rows[0][point], rows[1][point], a.weight),
                           mix(rows[2][point], rows[3][point], a.weight), b.weight);
    });
}

void Warp::column(std::size_t t, int lateral, int k, std::span<float> out) const {
    with_column(t, lateral, k, [&](const auto& value) {
        float low = value(0);
        out[0] = low;
        for (int point = 1; point < points_[0]; ++point) {
            const float high = value(static_cast<std::size_t>(point));
            const int first = vertex_of(0, point - 1), last = vertex_of(0, point);
            for (int u = first + 1; u < last; ++u)
                out[static_cast<std::size_t>(u)] = mix(
                    low, high, static_cast<float>(u - first) / static_cast<float>(last - first));
            out[static_cast<std::size_t>(last)] = high;
            low = high;
        }
    });
}

std::array<double, 2> Warp::ends(std::size_t t, int lateral, int k) const {
    std::array<double, 2> out{};
    with_column(t, lateral, k, [&](const auto& value) {
        out = {value(0), value(static_cast<std::size_t>(points_[0]) - 1)};
    });
    return out;
}

void Warp::anchor_at(const Anchor& anchor) {
    const auto row = static_cast<std::size_t>(points_[0]);
    const auto held = [&](std::span<const float> column) {
        switch (anchor.at) {
            case Anchor::At::low: return column.front();
            case Anchor::At::middle: return 0.5f * (column.front() + column.back());
            case Anchor::At::high: return column.back();
            case Anchor::At::vertex: break;
        }
        const auto at = points_around(anchor.vertex, vertices_[0], points_[0], factor_, false);
        return mix(column[at.low], column[at.high], at.weight);
    };
    for (std::size_t t = 0; t < frames(); ++t) {
        const auto all = values(t);
        each_in_parallel(all.size() / row, 64, [&](std::size_t c) {
            const auto column = all.subspan(c * row, row);
            const float shift = held(column);
            for (auto& value : column) value -= shift;
        });
    }
}

void Warp::find_bounds() {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    constexpr Range nothing{infinite, -infinite};
    const auto row = static_cast<std::size_t>(points_[0]);
    Bounds found{nothing, nothing, points_[0] > 1 ? nothing : Range{}, nothing};
    const auto joined = [](Bounds a, const Bounds& b) {
        a.first = around(a.first, b.first);
        a.last = around(a.last, b.last);
        a.slope = around(a.slope, b.slope);
        a.value = around(a.value, b.value);
        return a;
    };
    for (std::size_t t = 0; t < frames(); ++t) {
        const auto all = std::as_const(*this).values(t);
        found = tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, all.size() / row, 64), found,
            [&](const tbb::blocked_range<std::size_t>& columns, Bounds out) {
                for (auto c = columns.begin(); c < columns.end(); ++c) {
                    const auto column = all.subspan(c * row, row);
                    out.first = around(out.first, {column.front(), column.front()});
                    out.last = around(out.last, {column.back(), column.back()});
                    for (std::size_t p = 0; p < row; ++p) {
                        out.value = around(out.value, {column[p], column[p]});
                        if (p + 1 == row) break;
                        const int low = vertex_of(0, static_cast<int>(p)),
                                  high = vertex_of(0, static_cast<int>(p) + 1);
                        const float slope =
                            (column[p + 1] - column[p]) / static_cast<float>(high - low);
                        out.slope = around(out.slope, {slope, slope});
                    }
                }
                return out;
            },
            joined);
    }
    bounds_ = found;
}

Warp::Range Warp::scaled(const Range& range) const {
    const auto scale = static_cast<float>(scale_);
    return scale < 0 ? Range{scale * range.most, scale * range.least}
                     : Range{scale * range.least, scale * range.most};
}

}  // namespace fluidcarve
