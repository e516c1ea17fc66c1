#pragma once

#include "carve/volume/grid_types.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// A volume whose grids are `change(grid)`, called with the grid's own type.
/// Grids of points and of types that OpenVDB does not know stay as they are.
/// @param change  returns a grid pointer of any type; the grid itself if nothing changes
template <class Change>
Volume each_grid(const Volume& volume, const Change& change) {
    auto out = volume;
    for (auto& each : out.grids) {
        const auto grid = each.grid();
#define FLUIDCARVE_TRY(GridT)                                              \
    if (grid->isType<GridT>()) {                                           \
        each = each.holding(change(openvdb::GridBase::grid<GridT>(grid))); \
        continue;                                                          \
    }
        FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    }
    return out;
}

}  // namespace fluidcarve
