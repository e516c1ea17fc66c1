#include "nodes/remap/remap.h"

#include "graph/problem.h"
#include "nodes/io/triplet.h"
#include "nodes/lattice/alignment.h"
#include "nodes/remap/grid_types.h"
#include "nodes/remap/remap_aligned.h"

#include <fmt/format.h>

#include <optional>

namespace fluidcarve {

namespace {

/// The lattice's vertices as voxels, where each is one and neighbours are neighbours.
std::optional<Alignment> one_to_one(const Lattice& lattice, const openvdb::math::Transform& transform) {
    auto out = align(lattice, transform);
    if (out && !out->one_to_one()) out.reset();
    return out;
}

template <class GridT>
openvdb::GridBase::ConstPtr carve(const openvdb::GridBase::ConstPtr& base, const std::optional<Alignment>& alignment, const Lattice& lattice,
                                  const CarveMap& map, Interpolation interpolation) {
    const auto grid = openvdb::GridBase::grid<GridT>(base);
    return alignment ? carve_aligned<GridT>(grid, *alignment, map) : carve_sampled<GridT>(grid, Mapping(lattice, map.reach()), map, interpolation);
}

openvdb::GridBase::ConstPtr carve_any(const openvdb::GridBase::ConstPtr& grid, const std::optional<Alignment>& alignment, const Lattice& lattice,
                                      const CarveMap& map, Interpolation interpolation) {
#define FLUIDCARVE_TRY(GridT) \
    if (grid->isType<GridT>()) return carve<GridT>(grid, alignment, lattice, map, interpolation);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    throw Failure(fmt::format("grid '{}' is of type {}, which can't be carved; name the grids to carve in `grids:` of the reader and take those",
                              grid->getName(), grid->type()));
}

}  // namespace

openvdb::GridBase::ConstPtr carve_grid(const openvdb::GridBase::ConstPtr& grid, const Lattice& lattice, const CarveMap& map, Interpolation interpolation) {
    if (map.empty()) return grid;
    return carve_any(grid, one_to_one(lattice, grid->transform()), lattice, map, interpolation);
}

Volume carve_volume(const Volume& volume, const Lattice& lattice, const CarveMap& map, Interpolation interpolation) {
    if (map.empty()) return volume;
    Volume out = volume;
    for (auto& grid : out.grids) {
        // The faces of a staggered triplet stand between the voxels, and travel with theirs.
        const auto triplet = triplet_of(volume, *grid);
        grid = carve_any(grid, one_to_one(lattice, triplet ? *triplet->cells : grid->transform()), lattice, map, interpolation);
    }
    return out;
}

}  // namespace fluidcarve
