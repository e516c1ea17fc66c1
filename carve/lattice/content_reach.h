#pragma once

#include "carve/rig/rig.h"
#include "carve/volume/volume.h"

#include <optional>

namespace fluidcarve {

/// Size of a grid's visible part (ShownPart) around a rig, world units.
struct ContentReach {
    /// Widths along `u` and `v`: medians over the planes with visible content, without the ends of
    /// an open rig.
    double u = 0, v = 0;
    /// Distances to which it extends before the first and behind the last plane of an open rig.
    double before = 0, after = 0;
};

/// Measures the visible voxels of a grid, each at the nearest plane of the rig.
/// @return nothing if no plane that counts has visible content
/// @throws Failure as resampled() and untwisted()
std::optional<ContentReach> content_reach(const FloatGrid& grid, const Rig& rig);

}  // namespace fluidcarve
