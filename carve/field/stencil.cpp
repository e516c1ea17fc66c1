#include "carve/field/stencil.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/same_transform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {
namespace {

double largest_part(float value) { return std::abs(value); }
double largest_part(const openvdb::Vec3s& value) {
    return std::max({std::abs(value[0]), std::abs(value[1]), std::abs(value[2])});
}

template <class Grid>
[[noreturn]] void refuse(const Grid& grid, const openvdb::Coord& beside) {
    std::optional<openvdb::Coord> lowest;
    for (auto value = grid.cbeginValueOn(); value; ++value)
        if (!openvdb::math::isFinite(*value) && (!lowest || value.getCoord() < *lowest))
            lowest = value.getCoord();
    if (!lowest) {
        double most = 0;
        bool all = true;
        for (auto value = grid.cbeginValueAll(); value; ++value) {
            all = all && openvdb::math::isFinite(*value);
            most = std::max(most, largest_part(*value));
        }
        if (all)
            throw Failure(
                fmt::format("grid '{}' has values of up to {:.3g}, so large that what is computed "
                            "from them at voxel [{}] has no number: make them smaller with "
                            "field.ax",
                            grid.getName(), most, numbers_text(beside)));
    }
    const auto at = lowest.value_or(beside);
    throw Failure(
        fmt::format("grid '{}' has a value that is not finite (NaN or infinite) {} voxel [{}]; "
                    "repair it where it comes from",
                    grid.getName(), lowest ? "at" : "next to", numbers_text(at)));
}

}  // namespace

void require_cubes(const openvdb::GridBase& grid) {
    const auto& transform = grid.constTransform();
    if (are_cubes(transform)) return;
    const auto shape = transform.voxelSize();
    throw Failure(
        fmt::format("grid '{}' has voxels of {:.6g} x {:.6g} x {:.6g} ({}); distances need cubes, "
                    "as grid.resample makes them",
                    grid.getName(), shape.x(), shape.y(), shape.z(), transform.mapType()));
}

void refuse_not_finite(const FloatGrid& grid, const openvdb::Coord& beside) {
    refuse(grid, beside);
}
void refuse_not_finite(const VectorGrid& grid, const openvdb::Coord& beside) {
    refuse(grid, beside);
}

}  // namespace fluidcarve
