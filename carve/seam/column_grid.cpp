#include "carve/seam/column_grid.h"

#include "carve/seam/seams.h"

#include <tbb/parallel_for.h>

#include <vector>

namespace fluidcarve {

namespace {

/// Lines of columns: laterally, or over the slices.
struct ColumnLines {
    int count, size;            ///< number of lines, and of columns in each
    bool ring;                  ///< whether the last column of a line is beside its first
    std::size_t stride, apart;  ///< floats from column to column, and from line to line
};

/// Averages each line in place, from a copy.
void average_lines(const ColumnLines& lines, float* rows, std::size_t row, std::size_t columns,
                   const ColumnGrid::Mean& mean) {
    if (lines.size == 1) return;
    const int reach = static_cast<int>(columns / 2), size = lines.size;
    tbb::parallel_for(
        tbb::blocked_range<int>(0, lines.count), [&](const tbb::blocked_range<int>& range) {
            std::vector<float> copy(row * static_cast<std::size_t>(size));
            std::vector<const float*> beside(columns);
            for (int line = range.begin(); line < range.end(); ++line) {
                auto* const first = rows + static_cast<std::size_t>(line) * lines.apart;
                for (std::size_t n = 0; n < static_cast<std::size_t>(size); ++n)
                    std::copy_n(first + n * lines.stride, row, copy.data() + n * row);
                for (int at = 0; at < size; ++at) {
                    for (std::size_t n = 0; n < columns; ++n) {
                        const int near = at + static_cast<int>(n) - reach;
                        const int clamped = lines.ring ? (near % size + size) % size
                                                       : std::clamp(near, 0, size - 1);
                        beside[n] = copy.data() + static_cast<std::size_t>(clamped) * row;
                    }
                    mean(beside.data(), first + static_cast<std::size_t>(at) * lines.stride);
                }
            }
        });
}

}  // namespace

ColumnGrid::ColumnGrid(const Seams& seams, const std::array<int, 3>& origin)
    : axes{static_cast<int>(dimension(seams.axis)), static_cast<int>(lateral_dimension(seams.axis)),
           static_cast<int>(slice_dimension(seams.axis))},
      laterals(seams.laterals()),
      slices(seams.slices()),
      first_lateral(origin[lateral_dimension(seams.axis)]),
      first_slice(origin[slice_dimension(seams.axis)]),
      around(seams.around),
      closed(seams.slices_close()) {}

void ColumnGrid::average(float* rows, std::size_t row, std::size_t columns,
                         const Mean& mean) const {
    const auto slice = static_cast<std::size_t>(laterals) * row;
    average_lines({slices, laterals, around, row, slice}, rows, row, columns, mean);
    average_lines({laterals, slices, closed, slice, row}, rows, row, columns, mean);
}

}  // namespace fluidcarve
