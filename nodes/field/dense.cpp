#include "nodes/field/dense.h"

#include "graph/text/problem.h"
#include "graph/text/words.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {
namespace {

std::uint64_t tile_voxels_of(const openvdb::GridBase& grid) { return grid.activeVoxelCount() - grid.constBaseTree().activeLeafVoxelCount(); }

}  // namespace

bool grid_fits(double bytes, std::uint64_t budget) { return bytes <= static_cast<double>(std::max(budget, least_grid_memory)); }

void refuse_dense(const openvdb::GridBase& grid, const char* what, double bytes, std::uint64_t budget) {
    constexpr double most_bytes = 1e19;
    throw Failure(fmt::format("grid '{}' has {} active voxels, {} of them in tiles; {} would take {}, but --memory allows {}: crop the grid, or raise --memory",
                              grid.getName(), grid.activeVoxelCount(), tile_voxels_of(grid), what,
                              size_text(static_cast<std::uint64_t>(std::min(bytes, most_bytes))), size_text(budget)),
                  Failure::Kind::input);
}

void require_dense_fits(const openvdb::GridBase& grid, double value_bytes, std::uint64_t budget) {
    const double bytes = static_cast<double>(tile_voxels_of(grid)) * value_bytes;
    if (!grid_fits(bytes, budget)) refuse_dense(grid, "as voxels these", bytes, budget);
}

}  // namespace fluidcarve
