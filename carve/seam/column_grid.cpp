#include "carve/seam/column_grid.h"

#include "carve/seam/seams.h"

#include <tbb/parallel_for.h>

#include <vector>

namespace fluidcarve {

ColumnGrid::ColumnGrid(const Seams& seams, const std::array<int, 3>& origin)
    : axes{static_cast<int>(dimension(seams.axis)), static_cast<int>(lateral_dimension(seams.axis)),
           static_cast<int>(slice_dimension(seams.axis))},
      laterals(seams.laterals()),
      slices(seams.slices()),
      first_lateral(origin[lateral_dimension(seams.axis)]),
      first_slice(origin[slice_dimension(seams.axis)]),
      around(seams.around),
      closed(seams.slices_close()) {}

void ColumnGrid::average(float* rows, std::size_t row, bool over_slices, std::size_t columns,
                         const Mean& mean) const {
    const int reach = static_cast<int>(columns / 2), lines = over_slices ? laterals : slices,
              size = over_slices ? slices : laterals;
    if (size == 1) return;
    const bool ring = over_slices ? closed : around;
    const auto slice = static_cast<std::size_t>(laterals) * row, stride = over_slices ? slice : row,
               between = over_slices ? row : slice;
    // Every line of columns is averaged in place, from a copy.
    tbb::parallel_for(tbb::blocked_range<int>(0, lines), [&](const tbb::blocked_range<int>& range) {
        std::vector<float> copy(row * static_cast<std::size_t>(size));
        std::vector<const float*> beside(columns);
        for (int line = range.begin(); line < range.end(); ++line) {
            auto* const first = rows + static_cast<std::size_t>(line) * between;
            for (std::size_t n = 0; n < static_cast<std::size_t>(size); ++n)
                std::copy_n(first + n * stride, row, copy.data() + n * row);
            for (int at = 0; at < size; ++at) {
                for (std::size_t n = 0; n < columns; ++n) {
                    const int near = at + static_cast<int>(n) - reach;
                    const int clamped =
                        ring ? (near % size + size) % size : std::clamp(near, 0, size - 1);
                    beside[n] = copy.data() + static_cast<std::size_t>(clamped) * row;
                }
                mean(beside.data(), first + static_cast<std::size_t>(at) * stride);
            }
        }
    });
}

}  // namespace fluidcarve
