#include "carve/warp/weights.h"

#include "carve/solver/costs/code.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

/// The vertices of a dimension that are nearest to a point: first and last. A vertex halfway
/// between two points belongs to the lower one.
std::pair<int, int> vertices_near(int point, int vertices, int points, int factor) {
    const int at = point * factor, first = point == 0 ? 0 : at - (factor - 1) / 2;
    // If a dimension is not a ring, its last point stands at the last vertex, perhaps closer to
    // the point before it.
    return {std::min(first, vertices - 1),
            point + 1 == points ? vertices - 1 : std::min(at + factor / 2, vertices - 2)};
}

}  // namespace

void find_weights(const EnergyVolume& energy, const Typical& typical, const WarpPrices& prices,
                  const Warp& warp, FrameStore& weights) {
    const auto width = static_cast<std::size_t>(energy.width()),
               laterals = static_cast<std::size_t>(energy.laterals());
    const auto per_energy = static_cast<float>(1 / typical.energy),
               per_edge = static_cast<float>(prices.field / typical.edge);
    const float empty =
        prices.empty * (1 + (energy.has_field() ? prices.field : 0) + prices.evenness);
    const auto points = warp.points();
    const auto row = static_cast<std::size_t>(points[0]),
               columns = static_cast<std::size_t>(points[1]) * static_cast<std::size_t>(points[2]);
    // Adds the weights of a column's vertices to those of its points.
    const auto add_column = [&](std::size_t t, std::size_t column,
                                const std::vector<std::size_t>& point_of,
                                std::vector<double>& sums) {
        const auto* const codes = energy.codes(t) + column * width;
        const auto* const field =
            energy.has_field() ? &energy.field(t * energy.columns_per_frame() + column) : nullptr;
        const auto value = [&](std::size_t u) { return field->value(static_cast<int>(u)); };
        for (std::size_t u = 0; u < width; ++u) {
            float weight = soft_weight;
            if (codes[u] == protected_code) weight = rigid_weight;
            else if (codes[u] != attracted_code) {
                weight = decode_energy(codes[u]) * per_energy;
                const bool content = !field ? codes[u] > 0 : std::abs(value(u)) > typical.content;
                weight += content ? prices.evenness : empty;
                if (field)
                    weight += per_edge * std::abs(value(std::min(u + 1, width - 1)) -
                                                  value(u > 0 ? u - 1 : 0));
                weight = std::min(weight, most_ordinary_weight);
            }
            sums[point_of[u]] += static_cast<double>(weight);
        }
    };
    std::vector<std::size_t> point_of(width);
    std::vector<double> count(row);
    for (std::size_t p = 0; p < row; ++p) {
        const auto [first, last] =
            vertices_near(static_cast<int>(p), energy.width(), points[0], warp.factor());
        for (int u = first; u <= last; ++u) point_of[static_cast<std::size_t>(u)] = p;
        count[p] = last - first + 1;
    }
    const bool still = warp.frames() < energy.frames();
    for (std::size_t t = 0; t < warp.frames(); ++t)
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, columns, 64),
            [&](const tbb::blocked_range<std::size_t>& range) {
                std::vector<double> sums(row);
                for (auto c = range.begin(); c < range.end(); ++c) {
                    std::ranges::fill(sums, 0.0);
                    const auto lateral = vertices_near(static_cast<int>(c) % points[1],
                                                       energy.laterals(), points[1], warp.factor());
                    const auto slice = vertices_near(static_cast<int>(c) / points[1],
                                                     energy.slices(), points[2], warp.factor());
                    double all = 0;
                    for (std::size_t from = still ? 0 : t; from < (still ? energy.frames() : t + 1);
                         ++from)
                        for (int k = slice.first; k <= slice.second; ++k)
                            for (int j = lateral.first; j <= lateral.second; ++j, ++all)
                                add_column(from,
                                           static_cast<std::size_t>(j) +
                                               laterals * static_cast<std::size_t>(k),
                                           point_of, sums);
                    const auto out = weights.entries(t).subspan(c * row, row);
                    for (std::size_t p = 0; p < row; ++p)
                        out[p] = encode_energy(static_cast<float>(sums[p] / (all * count[p])));
                }
            });
}

}  // namespace fluidcarve
