#include "carve/remap/grid.h"

#include "carve/base/failure.h"
#include "carve/lattice/alignment.h"
#include "carve/points/point_grid.h"
#include "carve/remap/geometry/points.h"
#include "carve/remap/voxels/aligned.h"
#include "carve/stream/openvdb_types.h"
#include "carve/volume/grid_types.h"
#include "carve/volume/triplet.h"

#include <fmt/format.h>

#include <optional>

namespace fluidcarve {

namespace {

/// The alignment of lattice and grid, if each vertex is a voxel and neighbours are neighbours.
std::optional<Alignment> one_to_one(const Lattice& lattice,
                                    const openvdb::math::Transform& transform) {
    auto out = align(lattice, transform);
    if (out && !out->one_to_one()) out.reset();
    return out;
}

template <class GridT>
openvdb::GridBase::ConstPtr carve(const openvdb::GridBase::ConstPtr& base,
                                  const std::optional<Alignment>& alignment, const Lattice& lattice,
                                  const CarveMap& map, Interpolation interpolation) {
    const auto grid = openvdb::GridBase::grid<GridT>(base);
    // If displacements are smoothed, chains of steps would interpolate several times.
    const bool straight =
        !map.soft() || (map.steps().size() == 1 && !map.joins() && !map.rims_fade() &&
                        interpolation == Interpolation::linear);
    const auto aligned =
        alignment && straight ? carve_aligned<GridT>(grid, *alignment, map) : nullptr;
    return aligned && !map.rims_fade() ? aligned
                                       : carve_sampled<GridT>(grid, Mapping(lattice, map.reach()),
                                                              map, interpolation, aligned);
}

/// @param cells  transform of the voxels that the grid's values belong to
openvdb::GridBase::ConstPtr carve_any(const openvdb::GridBase::ConstPtr& grid,
                                      const openvdb::math::Transform& cells, const Lattice& whole,
                                      const CarveMap& map, Interpolation interpolation) {
    const auto given = map.extended(whole);
    const auto alignment = one_to_one(given, cells);
    const auto lattice =
        alignment && (map.rims_fade() || map.soft()) ? on_voxels(given, *alignment, cells) : given;
#define FLUIDCARVE_TRY(GridT) \
    if (grid->isType<GridT>()) return carve<GridT>(grid, alignment, lattice, map, interpolation);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    if (is_point_grid(*grid)) {
        require_sound(*grid, "the source");
        const auto points = carve_points(point_positions(*grid), point_identities(*grid), whole,
                                         map, default_jitter);
        return points.changed() ? with_images(*grid, points.images) : grid;
    }
    throw Failure(
        fmt::format("grid '{}' is of type {}, which can't be carved; name the grids to carve in "
                    "`grids:` of the reader and connect those",
                    grid->getName(), grid->type()));
}

}  // namespace

openvdb::GridBase::ConstPtr carve_grid(const openvdb::GridBase::ConstPtr& grid,
                                       const Lattice& lattice, const CarveMap& map,
                                       Interpolation interpolation) {
    if (map.empty()) return grid;
    return carve_any(grid, grid->transform(), lattice, map, interpolation);
}

Volume carve_volume(const Volume& volume, const Lattice& lattice, const CarveMap& map,
                    Interpolation interpolation) {
    if (map.empty()) return volume;
    Volume out = volume;
    for (auto& each : out.grids) {
        const auto grid = each.grid();
        // The components of a staggered triplet stand on faces, between the voxels. If whole
        // vertices move, they travel with their voxels.
        const auto triplet = triplet_of(volume, *grid);
        each = each.holding(carve_any(grid,
                                      triplet && !map.soft() ? *triplet->cells : grid->transform(),
                                      lattice, map, interpolation));
    }
    return out;
}

}  // namespace fluidcarve
