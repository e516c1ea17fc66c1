#pragma once

#include "carve/solver/costs/energy_volume.h"

namespace fluidcarve {

/// The eddies of a field along the carved axis (METHOD 8 "Thick seams").
struct Eddies {
    int width = 1;  ///< approximate width, vertices, at least 1: 1.5 times the distance at which
                    ///< the autocorrelation of the content falls to a half
    /// Number of eddies side by side: the sum of the field's changes along a column, divided by
    /// twice its highest value. 1: the content has a single smooth hump.
    double across = 1;

    /// Measures the eddies of a volume with a field.
    static Eddies of(const EnergyVolume& volume);
};

}  // namespace fluidcarve
