#pragma once

#include "carve/lattice/lattice.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// How wide what a grid shows (ShownPart) is in a lattice.
/// @return the number of entries along the axis at which a slice shows something in any of its
///   columns; the median of all slices that show something, since its ends are often cut obliquely;
///   0: none does
int width_in(const FloatGrid& grid, const Lattice& lattice, Axis axis);

}  // namespace fluidcarve
