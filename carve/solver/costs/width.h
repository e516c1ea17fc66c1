#pragma once

#include "carve/lattice/lattice.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// Width of a grid's visible part (ShownPart) in a lattice.
/// @return the number of entries along the axis at which any column of a slice has visible
///   content; the median over all slices with content, since its ends are often cut obliquely; 0
///   if none has
int width_in(const FloatGrid& grid, const Lattice& lattice, Axis axis);

}  // namespace fluidcarve
