#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

#include <vector>

namespace fluidcarve {

/// One energy to be added to others: `weight * clamp((energy - low) / (high - low), 0, 1)`; 0 throughout if low >= high.
struct EnergyTerm {
    Ref<FloatGrid> energy;
    float weight = 1;
    Interval range;
};

/// The weighted sum of energies, each remapped to [0, 1] (paper 5.1, eq. 9-11).
/// @param terms  at least one, all of one transform; where one is not active, the value that it holds counts (0, in energies)
/// @return energy from 0 to the sum of the weights, no unit, on the voxels that are active in any term; elsewhere that of
///         the terms' backgrounds, which is 0 for most
/// @throws Failure naming two terms whose transforms differ, or a grid and voxel whose value is not finite
FloatGrid::Ptr combined_energy(const std::vector<EnergyTerm>& terms);

NodeType energy_combine();

}  // namespace fluidcarve
