#include "nodes/field/laplacian.h"

#include "nodes/field/jacobian.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct FieldLaplacian {
    struct Params {};
    struct Ports {
        Ref<FloatGrid> field;
        Ref<FloatGrid> laplacian;
    };
    static void run(const Params&, Ports& io, Context& context) {
        require_stencil_fits(*io.field, sizeof(float), context.memory_budget());
        io.laplacian = laplacian_field(*io.field);
    }
};

}  // namespace

FloatGrid::Ptr laplacian_field(const FloatGrid& field) {
    const auto metric = Jacobian(field).metric();
    const auto out = map_stencil<FloatGrid>(field, 0.0f, [&metric](auto& s, const openvdb::Coord& at) {
        const auto beside = [&](int axis, int by, int other = 0, int other_by = 0) -> double {
            auto place = at;
            place[axis] += by;
            place[other] += other_by;
            return s.getValue(place);
        };
        const double here = s.getValue(at);
        double sum = 0;
        for (int a = 0; a < 3; ++a) {
            sum += metric(a, a) * (beside(a, 1) - 2 * here + beside(a, -1));
            for (int b = a + 1; b < 3; ++b)
                if (metric(a, b) != 0) sum += 0.5 * metric(a, b) * (beside(a, 1, b, 1) - beside(a, 1, b, -1) - beside(a, -1, b, 1) + beside(a, -1, b, -1));
        }
        return static_cast<float>(sum);
    });
    out->setName("laplacian of " + field.getName());
    return out;
}

NodeType field_laplacian() {
    return Declare<FieldLaplacian>("field.laplacian", "The Laplacian of a field, div grad: below 0 on peaks, above 0 in pits.")
        .input("field", &FieldLaplacian::Ports::field, "Density, temperature or any other field.")
        .output("laplacian", &FieldLaplacian::Ports::laplacian, "Units of `field` per square world unit, on its active voxels.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
