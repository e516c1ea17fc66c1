#pragma once

#include "carve/remap/grid.h"

namespace fluidcarve::test {

template <class Grid>
typename Grid::ConstPtr carved(const typename Grid::ConstPtr& grid, const Lattice& lattice,
                               const CarveMap& map,
                               Interpolation interpolation = Interpolation::linear) {
    return openvdb::GridBase::grid<Grid>(carve_grid(grid, lattice, map, interpolation));
}

}  // namespace fluidcarve::test
