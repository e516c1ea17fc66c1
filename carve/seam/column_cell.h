#pragma once

#include <algorithm>
#include <cmath>

namespace fluidcarve {

/// The four columns around a point, by their numbers along the lateral axis and the slice axis.
struct ColumnCell {
    int j, k;            ///< of the first column
    int next_j, next_k;  ///< of the columns beside it; where there is none, the same
};

/// The columns around a point. Beyond the outer columns the outermost cell counts.
/// @param lateral, slice     of the point, in columns from the first one
/// @param laterals, slices   number of columns
/// @param around, closed     whether the last lateral column, or slice, is beside the first
inline ColumnCell column_cell(double lateral, double slice, int laterals, int slices, bool around,
                              bool closed) {
    const auto cell = [](double x, int last) {
        return std::clamp(static_cast<int>(std::floor(x)), 0, std::max(0, last));
    };
    const int j = cell(lateral, laterals - (around ? 1 : 2)),
              k = cell(slice, slices - (closed ? 1 : 2));
    return {j, k, around ? (j + 1) % laterals : std::min(j + 1, laterals - 1),
            closed ? (k + 1) % slices : std::min(k + 1, slices - 1)};
}

}  // namespace fluidcarve
