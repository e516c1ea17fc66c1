#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <vector>

namespace fluidcarve {

/// One energy of a weighted sum: `weight * clamp((energy - low) / (high - low), 0, 1)`; 0
/// everywhere if low >= high.
struct EnergyTerm {
    Ref<FloatGrid> energy;
    float weight = 1;
    Interval range;
};

/// The weighted sum of energies, each remapped to [0, 1] (paper 5.1, eq. 9-11).
/// @param terms  at least one, all with the same transform. Inactive voxels count with their stored
///   value, 0 for most energies
/// @return a grid "energy" from 0 to the sum of the weights, no unit, active where any term is;
///   its background is the sum for the terms' backgrounds, mostly 0
/// @throws Failure naming two terms with different transforms, or a grid and a voxel with a value
///   that is not finite
FloatGrid::Ptr combined_energy(const std::vector<EnergyTerm>& terms);

}  // namespace fluidcarve
