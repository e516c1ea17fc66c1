#pragma once

#include "carve/base/values.h"
#include "carve/energy/combine.h"
#include "carve/volume/volume.h"

#include <vector>

namespace fluidcarve {

/// Weights of the terms: the paper's lambda for the kinetic energy, and a weight for the curvature.
struct SurfaceWeights {
    float curvature = 1;
    float kinetic = 1;  ///< lambda
};

/// The energy of liquids and meshes, |H| + lambda u . u (paper 5.1.2, eq. 7), as terms of
/// combined_energy: curvature_energy of the surface, then kinetic_energy of the velocity. The
/// caller must set their ranges, which depend on the whole sequence.
/// @param velocity  may be null: no kinetic term
/// @throws Failure as the energies
std::vector<EnergyTerm> surface_terms(const FloatGrid& surface, const Ref<VectorGrid>& velocity,
                                      const SurfaceWeights& weights);

}  // namespace fluidcarve
