#pragma once

#include "carve/mesh/mesh.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// The surface on which a grid has a given value, as quads, and as triangles where flat parts are
/// coarsened. Faces are oriented outwards: to rising values in level sets and in grids whose
/// background is above the value, else to falling values.
/// @param isovalue    the value, in the grid's unit
/// @param adaptivity  0: one quad per voxel; up to 1: fewer and larger faces where the surface is
///   flat
Mesh surface_mesh(const FloatGrid& grid, double isovalue, double adaptivity);

}  // namespace fluidcarve
