#pragma once

#include "carve/base/values.h"
#include "carve/energy/combine.h"
#include "carve/volume/volume.h"

#include <vector>

namespace fluidcarve {

/// Weights of the terms: the paper's lambdas, and a weight for the vorticity.
struct VolumeWeights {
    float vorticity = 1;
    float kinetic = 1;   ///< lambda 1
    float gradient = 1;  ///< lambda 2, for each field
};

/// The energy of smoke and fire, |curl u| + lambda1 u . u + lambda2 sum |grad s| (paper 5.1.3, eq.
/// 10), as terms of combined_energy: vorticity_energy and kinetic_energy of the velocity, then
/// gradient_energy of each field. The caller must set their ranges, which depend on the whole
/// sequence.
/// @param velocity  may be null: no vorticity and no kinetic term
/// @throws Failure as the energies
std::vector<EnergyTerm> volume_terms(const Ref<VectorGrid>& velocity,
                                     const std::vector<Ref<FloatGrid>>& fields,
                                     const VolumeWeights& weights);

}  // namespace fluidcarve
