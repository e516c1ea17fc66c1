#include "carve/energy/vorticity.h"

#include "carve/base/values.h"
#include "carve/field/collocate.h"
#include "carve/field/differences.h"
#include "carve/field/stencil.h"

namespace fluidcarve {

FloatGrid::Ptr vorticity_energy(const Ref<VectorGrid>& velocity, float gain) {
    const auto out = map_stencil<FloatGrid>(
        *collocated(velocity), 0.0f,
        [gain, jacobian = Jacobian(*velocity)](auto& v, const openvdb::Coord& at) {
            return static_cast<float>(gain * openvdb::Vec3d(curl_at(v, at, jacobian)).length());
        });
    out->setName("vorticity of " + velocity->getName());
    return out;
}

}  // namespace fluidcarve
