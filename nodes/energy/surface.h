#pragma once

#include "graph/types/node_type.h"
#include "nodes/energy/combine.h"
#include "nodes/payloads.h"

#include <vector>

namespace fluidcarve {

/// A weight for the curvature, and the paper's lambda.
struct SurfaceWeights {
    float curvature = 1;
    float kinetic = 1;  ///< lambda
};

/// The energy of liquids and meshes, |H| + lambda u . u (paper 5.1.2, eq. 7), as terms of combined_energy: curvature_energy of the surface, then
/// kinetic_energy of the velocity. Their ranges are left to the caller, who knows the sequence.
/// @param velocity  may be null: no such term
/// @throws Failure as the energies
std::vector<EnergyTerm> surface_terms(const FloatGrid& surface, const Ref<VectorGrid>& velocity, const SurfaceWeights& weights);

NodeType energy_surface();

}  // namespace fluidcarve
