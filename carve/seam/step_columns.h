#pragma once

#include "carve/seam/carve_map.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace fluidcarve {

/// The four columns of a step around a point. The step's displacements are bilinear between them.
class StepColumns {
public:
    /// @param at  coordinates inside the step's lattice, vertices
    StepColumns(const CarveStep& step, const openvdb::Vec3d& at)
        : step_(step), cell_(step.columns().cell(at)) {
        const double b = cell_.lateral, c = cell_.slice;
        for (std::size_t n = 0; n < 4; ++n) {
            weights_[n] = (n & 1 ? b : 1 - b) * (n & 2 ? c : 1 - c);
            all_[n] = step.first_displaced(cell_.columns[n]);
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
                return static_cast<double>(soft->entry(entry, cell_.columns[column]));
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
    const ColumnGrid::Cell cell_;
    std::array<double, 4> weights_;
    std::array<std::span<const std::uint16_t>, 4> all_;
};

}  // namespace fluidcarve
