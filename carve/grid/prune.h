#pragma once

#include "carve/volume/volume.h"

#include <optional>

namespace fluidcarve {

/// Joins equal neighbouring voxels of all grids to tiles, by openvdb::tools::prune.
/// @param tolerance  largest difference of joined values, in each grid's unit
/// @param below      values of floats, or lengths of vectors, under it become background and
///   inactive; level sets are left out
Volume pruned(const Volume& volume, double tolerance, std::optional<double> below);

}  // namespace fluidcarve
