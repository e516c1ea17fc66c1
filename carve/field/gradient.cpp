#include "carve/field/gradient.h"

#include "carve/field/differences.h"
#include "carve/field/stencil.h"

namespace fluidcarve {

VectorGrid::Ptr gradient_field(const FloatGrid& field) {
    const auto out = map_stencil<VectorGrid>(
        field, openvdb::Vec3s(0), [jacobian = Jacobian(field)](auto& s, const openvdb::Coord& at) {
            return jacobian.gradient(differences_at(s, at));
        });
    out->setName("gradient of " + field.getName());
    out->setVectorType(openvdb::VEC_COVARIANT);
    return out;
}

}  // namespace fluidcarve
