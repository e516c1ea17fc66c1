#include "carve/field/curl.h"

#include "carve/base/values.h"
#include "carve/field/collocate.h"
#include "carve/field/differences.h"
#include "carve/field/stencil.h"

namespace fluidcarve {

VectorGrid::Ptr curl_field(const Ref<VectorGrid>& velocity) {
    const auto out = map_stencil<VectorGrid>(
        *collocated(velocity), openvdb::Vec3s(0),
        [jacobian = Jacobian(*velocity)](auto& v, const openvdb::Coord& at) {
            return curl_at(v, at, jacobian);
        });
    out->setName("curl of " + velocity->getName());
    out->setVectorType(openvdb::VEC_COVARIANT);
    return out;
}

}  // namespace fluidcarve
