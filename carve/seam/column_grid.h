#pragma once

#include <openvdb/Types.h>
#include <openvdb/math/Coord.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

namespace fluidcarve {

struct Seams;

/// The columns of a set of seams in one frame, and where they stand in the space that the set
/// carves. Lateral columns and slices are counted as vertices: from first_lateral and first_slice
/// on.
struct ColumnGrid {
    /// The columns of a set.
    /// @param origin  first vertex of the space that it carves
    ColumnGrid(const Seams& seams, const std::array<int, 3>& origin);

    /// The carved, the lateral and the slice axis: indices of the dimensions in a vertex's
    /// coordinates.
    std::array<int, 3> axes;
    int laterals, slices;
    int first_lateral, first_slice;
    bool around;  ///< whether column `laterals` is column 0 again; first_lateral is then 0
    bool closed;  ///< whether slice `slices` is slice 0 again; first_slice is then 0

    int axis() const { return axes[0]; }
    int lateral_axis() const { return axes[1]; }
    int slice_axis() const { return axes[2]; }
    int last_lateral() const { return first_lateral + laterals - 1; }
    int last_slice() const { return first_slice + slices - 1; }
    /// Up to where points have columns; in a ring this is its first column again.
    int end_lateral() const { return around ? laterals : last_lateral(); }
    int end_slice() const { return closed ? slices : last_slice(); }

    std::size_t count() const {
        return static_cast<std::size_t>(laterals) * static_cast<std::size_t>(slices);
    }
    /// The place of a column among all, lateral fastest. The column must exist.
    std::size_t index(int lateral, int slice) const {
        return static_cast<std::size_t>(lateral - first_lateral) +
               static_cast<std::size_t>(laterals) * static_cast<std::size_t>(slice - first_slice);
    }
    /// A lateral number, from -laterals on; in a ring, that of the column where it goes round.
    int turned_lateral(int lateral) const {
        return around ? (lateral + laterals) % laterals : lateral;
    }
    int turned_slice(int slice) const { return closed ? (slice + slices) % slices : slice; }
    /// The index of the column at turned numbers; beyond the last one, that of the last.
    std::size_t index_within(int lateral, int slice) const {
        return index(std::min(turned_lateral(lateral), last_lateral()),
                     std::min(turned_slice(slice), last_slice()));
    }
    /// Whether the column of a vertex exists.
    bool has(const openvdb::Coord& vertex) const {
        const int lateral = vertex[lateral_axis()], slice = vertex[slice_axis()];
        return lateral >= first_lateral && lateral <= last_lateral() && slice >= first_slice &&
               slice <= last_slice();
    }
    /// Whether a point lies on a column or between columns.
    bool holds(const openvdb::Vec3d& at) const {
        const double lateral = at[lateral_axis()], slice = at[slice_axis()];
        return lateral >= first_lateral && lateral <= end_lateral() && slice >= first_slice &&
               slice <= end_slice();
    }

    /// The four columns around a point.
    struct Cell {
        /// Indices: the first column, the next one laterally, and the same in the next slice. Where
        /// there is no next one, it is the same.
        std::array<std::size_t, 4> columns;
        double lateral, slice;  ///< of the point, from the first column, in columns
    };
    /// Beyond the outer columns the outermost cell counts.
    Cell cell(const openvdb::Vec3d& at) const {
        const auto low = [](double x, int last) {
            return std::clamp(static_cast<int>(std::floor(x)), 0, std::max(0, last));
        };
        const double lateral = at[lateral_axis()] - first_lateral,
                     slice = at[slice_axis()] - first_slice;
        const int j = low(lateral, laterals - (around ? 1 : 2)),
                  k = low(slice, slices - (closed ? 1 : 2)),
                  next_j = around ? (j + 1) % laterals : std::min(j + 1, laterals - 1),
                  next_k = closed ? (k + 1) % slices : std::min(k + 1, slices - 1);
        const auto of = [this](int column, int along) {
            return index(first_lateral + column, first_slice + along);
        };
        return {
            {of(j, k), of(next_j, k), of(j, next_k), of(next_j, next_k)}, lateral - j, slice - k};
    }

    /// Writes the mean of rows of floats to a row that is none of them.
    using Mean = std::function<void(const float* const* rows, float* to)>;
    /// Replaces each column's row of floats by a mean over its lateral neighbours, then by one over
    /// neighbouring slices. Rings go round; beyond an outer column its own row counts.
    /// @param rows     `[column][float]`
    /// @param row      number of floats in each
    /// @param columns  number of columns in a mean, the column itself in the middle; odd
    void average(float* rows, std::size_t row, std::size_t columns, const Mean& mean) const;
};

}  // namespace fluidcarve
