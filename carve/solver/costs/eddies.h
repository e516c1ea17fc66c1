#pragma once

#include "carve/solver/costs/volume.h"

namespace fluidcarve {

/// The eddies of a field along the carved axis (METHOD 8 "Thick seams").
struct Eddies {
    int width = 1;  ///< about how wide they are, vertices, at least 1: 1.5 times the distance at
                    ///< which the autocorrelation of the content falls to a half
    /// How many the content has side by side: by how much the field rises and falls along a column,
    /// as a share of its highest value there and back. 1: the content is one smooth thing.
    double across = 1;

    /// Measures the eddies of a volume with a field.
    static Eddies of(const EnergyVolume& volume);
};

}  // namespace fluidcarve
