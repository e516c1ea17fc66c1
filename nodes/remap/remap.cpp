#include "nodes/remap/remap.h"

#include "graph/problem.h"
#include "nodes/lattice/alignment.h"
#include "nodes/remap/grid_types.h"
#include "nodes/remap/remap_aligned.h"

#include <fmt/format.h>

#include <optional>

namespace fluidcarve {

namespace {

/// Where a lattice lies in a grid, found out once for all grids of a transform.
struct Place {
    std::optional<Alignment> alignment;
    Mapping mapping;

    Place(const Lattice& lattice, const CarveMap& map, const openvdb::math::Transform& transform)
        : alignment(align(lattice, transform)), mapping(lattice, map.reach()) {
        if (alignment && !alignment->one_to_one()) alignment.reset();
    }
};

template <class GridT>
openvdb::GridBase::ConstPtr carve(const openvdb::GridBase::ConstPtr& base, const Place& place, const CarveMap& map, Interpolation interpolation) {
    const auto grid = openvdb::GridBase::grid<GridT>(base);
    return place.alignment ? carve_aligned<GridT>(grid, *place.alignment, map) : carve_sampled<GridT>(grid, place.mapping, map, interpolation);
}

}  // namespace

openvdb::GridBase::ConstPtr carve_grid(const openvdb::GridBase::ConstPtr& grid, const Lattice& lattice, const CarveMap& map, Interpolation interpolation) {
    if (map.empty()) return grid;
    const Place place(lattice, map, grid->transform());
#define FLUIDCARVE_TRY(GridT) \
    if (grid->isType<GridT>()) return carve<GridT>(grid, place, map, interpolation);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    throw Failure(fmt::format("grid '{}' is of type {}, which can't be carved; name the grids to carve in `grids:` of the reader and take those",
                              grid->getName(), grid->type()));
}

Volume carve_volume(const Volume& volume, const Lattice& lattice, const CarveMap& map, Interpolation interpolation) {
    Volume out = volume;
    for (auto& grid : out.grids) grid = carve_grid(grid, lattice, map, interpolation);
    return out;
}

}  // namespace fluidcarve
