#pragma once

#include "carve/lattice/lattice.h"

#include <cstddef>

namespace fluidcarve {

/// Number of folded cells of a lattice. Neighbouring planes cross in such a cell, so that positions
/// there have no coordinates.
struct Folds {
    std::size_t cells = 0;
    int plane = 0;  ///< lower plane of the slab with most folded cells; the first such plane
    std::size_t in_plane = 0;  ///< folded cells in that slab
};

/// Counts the folded cells of a lattice. A cell is not folded if, at all its corners, the upper
/// plane's vertices lie above the lower plane and the lower plane's vertices lie below the upper
/// plane (METHOD 2). A dimension of one vertex counts as one cell.
/// @param extent_u, extent_v  vertices along u and v: the lattice's I and J, or more where
///   insertions extend it; around a rig v stays J
Folds count_folds(const Lattice& lattice, int extent_u, int extent_v);

}  // namespace fluidcarve
