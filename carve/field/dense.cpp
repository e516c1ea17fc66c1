#include "carve/field/dense.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {

bool grid_fits(double bytes, std::uint64_t budget) {
    return bytes <= static_cast<double>(std::max(budget, least_grid_memory));
}

void require_dense_fits(const openvdb::GridBase& grid, double value_bytes, std::uint64_t budget) {
    const auto in_tiles = grid.activeVoxelCount() - grid.constBaseTree().activeLeafVoxelCount();
    const double bytes = static_cast<double>(in_tiles) * value_bytes;
    if (grid_fits(bytes, budget)) return;
    constexpr double most_bytes = 1e19;
    throw Failure(fmt::format("grid '{}' has {} active voxels, {} of them in tiles; as voxels "
                              "these would take {}, but --memory allows {}: crop the grid, or "
                              "raise --memory",
                              grid.getName(), grid.activeVoxelCount(), in_tiles,
                              size_text(static_cast<std::uint64_t>(std::min(bytes, most_bytes))),
                              size_text(budget)),
                  Failure::Kind::input);
}

}  // namespace fluidcarve
