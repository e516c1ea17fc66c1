#pragma once

#include "carve/seam/carve_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace fluidcarve {

/// The four columns of a step around a point. The step's displacements are bilinear between them.
class StepColumns {
public:
    /// @param at  coordinates inside the step's lattice, vertices
    StepColumns(const CarveStep& step, const openvdb::Vec3d& at) : step_(step) {
        const double lateral = at[step.lateral_axis()], slice = at[step.slice_axis()];
        const auto cell = [](double x, int first, int last) {
            return std::clamp(static_cast<int>(std::floor(x)), first, std::max(first, last));
        };
        const int j = cell(lateral, step.first_lateral(),
                           step.last_lateral() - (step.around() ? 0 : 1)),
                  k = cell(slice, step.first_slice(), step.last_slice() - (step.closed() ? 0 : 1));
        const double b = lateral - j, c = slice - k;
        for (std::size_t n = 0; n < 4; ++n) {
            const bool next_j = n & 1, next_k = n & 2;
            weights_[n] = (next_j ? b : 1 - b) * (next_k ? c : 1 - c);
            // A column of weight 0 may not exist.
            places_[n] = {
                weights_[n] > 0 && next_j ? (step.around() ? (j + 1) % step.laterals() : j + 1) : j,
                weights_[n] > 0 && next_k ? (step.closed() ? (k + 1) % step.slices() : k + 1) : k};
            all_[n] = step.first_displaced(places_[n][0], places_[n][1]);
        }
    }

    /// Number of first displaced entries in each column.
    std::size_t size() const { return all_[0].size(); }
    /// The n-th of CarveStep::first_displaced, interpolated between the columns; an entry.
    double bound(std::size_t n) const {
        return between([&](std::size_t column) { return static_cast<double>(all_[column][n]); });
    }
    /// CarveStep::displacement, interpolated between the columns, in vertices. Exact where the
    /// columns agree.
    double displacement(int entry) const {
        return between([&](std::size_t column) {
            if (const auto* const soft = step_.soft())
                return static_cast<double>(
                    soft->entry(entry, places_[column][0], places_[column][1]));
            return 0.5 *
                   step_.displacement(entry, CarveStep::passed(entry, all_[column]), all_[column]);
        });
    }

private:
    template <class Value>
    double between(const Value& value) const {
        const double first = value(0);
        double out = first;
        for (std::size_t n = 1; n < 4; ++n)
            if (weights_[n] > 0) out += weights_[n] * (value(n) - first);
        return out;
    }

    const CarveStep& step_;
    std::array<double, 4> weights_;
    std::array<std::array<int, 2>, 4> places_;  ///< `[column]`: lateral, slice
    std::array<std::span<const std::uint16_t>, 4> all_;
};

}  // namespace fluidcarve
