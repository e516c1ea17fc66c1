#include "nodes/field/stencil.h"

#include "graph/text/problem.h"
#include "nodes/field/same_transform.h"

#include <fmt/format.h>

namespace fluidcarve {
namespace {

template <class Grid>
[[noreturn]] void refuse(const Grid& grid, const openvdb::Coord& beside) {
    std::optional<openvdb::Coord> lowest;
    for (auto value = grid.cbeginValueOn(); value; ++value)
        if (!openvdb::math::isFinite(*value) && (!lowest || value.getCoord() < *lowest)) lowest = value.getCoord();
    const auto at = lowest.value_or(beside);
    throw Failure(fmt::format("grid '{}' has a value that is not finite (NaN or infinite) {} voxel [{}, {}, {}]; repair it where it comes from", grid.getName(),
                              lowest ? "at" : "next to", at.x(), at.y(), at.z()));
}

}  // namespace

void require_cubes(const openvdb::GridBase& grid) {
    const auto& transform = grid.constTransform();
    if (are_cubes(transform)) return;
    const auto shape = transform.voxelSize();
    throw Failure(fmt::format("grid '{}' has voxels of {:.6g} x {:.6g} x {:.6g} ({}); distances need cubes, as grid.resample makes them", grid.getName(),
                              shape.x(), shape.y(), shape.z(), transform.mapType()));
}

void refuse_not_finite(const FloatGrid& grid, const openvdb::Coord& beside) { refuse(grid, beside); }
void refuse_not_finite(const VectorGrid& grid, const openvdb::Coord& beside) { refuse(grid, beside); }

}  // namespace fluidcarve
