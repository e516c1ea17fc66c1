#include "carve/energy/gradient.h"

#include "carve/field/differences.h"
#include "carve/field/stencil.h"

namespace fluidcarve {

FloatGrid::Ptr gradient_energy(const FloatGrid& field, float gain) {
    const auto out = map_stencil<FloatGrid>(
        field, 0.0f, [gain, jacobian = Jacobian(field)](auto& s, const openvdb::Coord& at) {
            return static_cast<float>(gain * jacobian.steepness(differences_at(s, at)));
        });
    out->setName("gradient of " + field.getName());
    return out;
}

}  // namespace fluidcarve
