#pragma once

#include "carve/rig/rig.h"
#include "carve/volume/volume.h"

#include <optional>

namespace fluidcarve {

/// How far what a grid shows (ShownPart) reaches around a rig, world units.
struct ContentReach {
    /// Its widths along `u` and `v`: medians over all planes across the rig that show something.
    double u = 0, v = 0;
    /// How far it goes on before the first and behind the last plane of an open rig, straight.
    double before = 0, after = 0;
};

/// Measures the voxels of a grid at the planes of the rig that are nearest to them.
/// @return nothing if the grid shows nothing beside the rig
/// @throws Failure as resampled() and untwisted()
std::optional<ContentReach> content_reach(const FloatGrid& grid, const Rig& rig);

}  // namespace fluidcarve
