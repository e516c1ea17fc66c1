#include "carve/warp/weights.h"

#include "carve/solver/costs/code.h"
#include "carve/warp/warp_system.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
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

/// Weights of points, from those of the vertices nearest to them.
class PointWeights {
public:
    PointWeights(const EnergyVolume& energy, const Typical& typical, const WarpWeights& stated,
                 const Warp& warp)
        : energy_(energy),
          points_(warp.points()),
          factor_(warp.factor()),
          content_(typical.content),
          per_energy_(static_cast<float>(1 / typical.energy)),
          per_edge_(static_cast<float>(stated.field / typical.edge)),
          evenness_(stated.evenness),
          empty_(stated.empty * (1 + (energy.has_field() ? stated.field : 0) + stated.evenness)),
          point_of_(static_cast<std::size_t>(energy.width())),
          count_(static_cast<std::size_t>(points_[0])) {
        for (std::size_t p = 0; p < count_.size(); ++p) {
            const auto [first, last] =
                vertices_near(static_cast<int>(p), energy.width(), points_[0], factor_);
            for (int u = first; u <= last; ++u) point_of_[static_cast<std::size_t>(u)] = p;
            count_[p] = last - first + 1;
        }
    }

    /// Finds the weights of a column of points.
    /// @param begin, end  frames
    /// @param sums        memory
    void find(std::size_t begin, std::size_t end, std::size_t c, std::vector<double>& sums,
              std::span<std::uint16_t> out) const {
        sums.assign(count_.size(), 0.0);
        const auto lateral = vertices_near(static_cast<int>(c) % points_[1], energy_.laterals(),
                                           points_[1], factor_),
                   slice = vertices_near(static_cast<int>(c) / points_[1], energy_.slices(),
                                         points_[2], factor_);
        const auto laterals = static_cast<std::size_t>(energy_.laterals());
        double all = 0;
        for (auto t = begin; t < end; ++t)
            for (int k = slice.first; k <= slice.second; ++k)
                for (int j = lateral.first; j <= lateral.second; ++j, ++all)
                    add_column(t,
                               static_cast<std::size_t>(j) + laterals * static_cast<std::size_t>(k),
                               sums);
        for (std::size_t p = 0; p < out.size(); ++p)
            out[p] = encode_energy(static_cast<float>(sums[p] / (all * count_[p])));
    }

private:
    /// Adds the weights of a column's vertices to those of their points.
    void add_column(std::size_t t, std::size_t column, std::vector<double>& sums) const {
        const auto width = point_of_.size();
        const auto* const codes = energy_.codes(t) + column * width;
        const auto* const field = energy_.has_field()
                                      ? &energy_.field(t * energy_.columns_per_frame() + column)
                                      : nullptr;
        const auto value = [&](std::size_t u) { return field->value(static_cast<int>(u)); };
        for (std::size_t u = 0; u < width; ++u) {
            float weight = soft_weight;
            if (codes[u] == protected_code) weight = rigid_weight;
            else if (codes[u] != attracted_code) {
                weight = decode_energy(codes[u]) * per_energy_;
                const bool content = !field ? codes[u] > 0 : std::abs(value(u)) > content_;
                weight += content ? evenness_ : empty_;
                if (field)
                    weight += per_edge_ * std::abs(value(std::min(u + 1, width - 1)) -
                                                   value(u > 0 ? u - 1 : 0));
                weight = std::min(weight, most_ordinary_weight);
            }
            sums[point_of_[u]] += static_cast<double>(weight);
        }
    }

    const EnergyVolume& energy_;
    const std::array<int, 3> points_;
    const int factor_;
    const float content_;
    const float per_energy_, per_edge_, evenness_;
    const float empty_;                  ///< of a vertex without content
    std::vector<std::size_t> point_of_;  ///< `[u]`
    std::vector<double> count_;          ///< vertices of each point along u
};

}  // namespace

void find_weights(const EnergyVolume& energy, const Typical& typical, const WarpWeights& stated,
                  const Warp& warp, FrameStore& weights) {
    const PointWeights of_points(energy, typical, stated, warp);
    const auto points = warp.points();
    const auto row = static_cast<std::size_t>(points[0]),
               columns = static_cast<std::size_t>(points[1]) * static_cast<std::size_t>(points[2]);
    const bool still = warp.frames() < energy.frames();
    for (std::size_t t = 0; t < warp.frames(); ++t)
        tbb::parallel_for(WarpColumnRange(0, columns, warp_columns_per_task),
                          [&](const WarpColumnRange& range) {
                              std::vector<double> sums;
                              for (auto c = range.begin(); c < range.end(); ++c)
                                  of_points.find(still ? 0 : t, still ? energy.frames() : t + 1, c,
                                                 sums, weights.entries(t).subspan(c * row, row));
                          });
}

}  // namespace fluidcarve
