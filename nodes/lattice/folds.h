#pragma once

#include "nodes/lattice/lattice.h"

#include <cstddef>

namespace fluidcarve {

/// Cells of a lattice in which neighbouring planes cross: no position has a place there.
struct Folds {
    std::size_t cells = 0;
    int plane = 0;             ///< the lower plane of those that hold most of them; the first such plane
    std::size_t in_plane = 0;  ///< how many that is
};

/// A cell is folded unless, at its corners, the upper plane's vertices lie above the lower plane and the lower plane's
/// below the upper one (METHOD 2). A dimension of one vertex counts as one cell.
/// @param extent  vertices I, J along u and v: the lattice's, or more where insertions extend it
Folds count_folds(const Lattice& lattice, int extent_u, int extent_v);

}  // namespace fluidcarve
