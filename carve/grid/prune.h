#pragma once

#include "carve/volume/volume.h"

#include <optional>

namespace fluidcarve {

/// All grids with equal neighbours joined to tiles, by openvdb::tools::prune.
/// @param tolerance  by which values may differ that become one, in each grid's unit
/// @param below      values of floats, or lengths of vectors, under it become background and
///   inactive; level sets are left out
Volume pruned(const Volume& volume, double tolerance, std::optional<double> below);

}  // namespace fluidcarve
