#include "carve/energy/surface.h"

#include "carve/base/values.h"
#include "carve/energy/curvature.h"
#include "carve/energy/kinetic.h"

namespace fluidcarve {

std::vector<EnergyTerm> surface_terms(const FloatGrid& surface, const Ref<VectorGrid>& velocity,
                                      const SurfaceWeights& weights) {
    std::vector<EnergyTerm> out{{curvature_energy(surface, 1), weights.curvature, {}}};
    if (velocity) out.push_back({kinetic_energy(velocity, 1), weights.kinetic, {}});
    return out;
}

}  // namespace fluidcarve
