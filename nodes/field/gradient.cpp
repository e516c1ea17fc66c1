#include "nodes/field/gradient.h"

#include "nodes/field/differences.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct FieldGradient {
    struct Params {};
    struct Ports {
        Ref<FloatGrid> field;
        Ref<VectorGrid> gradient;
    };
    static void run(const Params&, Ports& io, Context& context) {
        require_stencil_fits(*io.field, sizeof(openvdb::Vec3s), context.memory_budget());
        io.gradient = gradient_field(*io.field);
    }
};

}  // namespace

VectorGrid::Ptr gradient_field(const FloatGrid& field) {
    const auto out = map_stencil<VectorGrid>(
        field, openvdb::Vec3s(0), [jacobian = Jacobian(field)](auto& s, const openvdb::Coord& at) { return jacobian.gradient(differences_at(s, at)); });
    out->setName("gradient of " + field.getName());
    out->setVectorType(openvdb::VEC_COVARIANT);
    return out;
}

NodeType field_gradient() {
    return Declare<FieldGradient>("field.gradient", "The gradient of a field: the direction and steepness of its rise.")
        .input("field", &FieldGradient::Ports::field, "Density, temperature or any other field.")
        .output("gradient", &FieldGradient::Ports::gradient, "grad field, units of `field` per world unit, on its active voxels.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
