#include "carve/energy/kinetic.h"

#include "carve/base/values.h"
#include "carve/field/collocate.h"
#include "carve/field/stencil.h"

namespace fluidcarve {

FloatGrid::Ptr kinetic_energy(const Ref<VectorGrid>& velocity, float gain) {
    const auto out =
        map_values<FloatGrid>(*collocated(velocity), 0.0f,
                              [gain](const openvdb::Vec3s& u) { return gain * u.lengthSqr(); });
    out->setName("kinetic energy of " + velocity->getName());
    return out;
}

}  // namespace fluidcarve
