#include "carve/energy/volume.h"

#include "carve/base/values.h"
#include "carve/energy/gradient.h"
#include "carve/energy/kinetic.h"
#include "carve/energy/vorticity.h"
#include "carve/field/collocate.h"

namespace fluidcarve {

std::vector<EnergyTerm> volume_terms(const Ref<VectorGrid>& velocity,
                                     const std::vector<Ref<FloatGrid>>& fields,
                                     const VolumeWeights& weights) {
    std::vector<EnergyTerm> out;
    if (velocity) {
        const auto centred = collocated(velocity);
        out.push_back({vorticity_energy(centred, 1), weights.vorticity, {}});
        out.push_back({kinetic_energy(centred, 1), weights.kinetic, {}});
    }
    for (const auto& field : fields)
        out.push_back({gradient_energy(*field, 1), weights.gradient, {}});
    return out;
}

}  // namespace fluidcarve
