#pragma once

#include "carve/points/points.h"
#include "carve/volume/volume.h"

#include <cstddef>

namespace fluidcarve {

/// Result of kept_out.
struct KeptOut {
    Points points;
    std::size_t moved = 0;  ///< number of points moved
    /// Number of points too deep inside for the narrow band to show the way out; they stay.
    std::size_t stuck = 0;
};

/// Moves each point inside a solid to the nearest place on its surface. All other points stay bit
/// for bit.
/// @param solid  a level set, world units, negative inside
KeptOut kept_out(const Points& points, const FloatGrid& solid);

}  // namespace fluidcarve
