#include "nodes/field/laplacian.h"

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
    const double voxel = cubic_voxel_size(field), scale = 1 / (voxel * voxel);
    const auto out = map_stencil<FloatGrid>(field, 0.0f, [scale](auto& s, const openvdb::Coord& at) {
        double sum = -6 * static_cast<double>(s.getValue(at));
        for (int axis = 0; axis < 3; ++axis)
            for (const int by : {-1, 1}) {
                auto beside = at;
                beside[axis] += by;
                sum += s.getValue(beside);
            }
        return static_cast<float>(scale * sum);
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
