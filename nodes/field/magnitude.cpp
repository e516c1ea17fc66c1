#include "nodes/field/magnitude.h"

#include "nodes/field/collocate.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct FieldMagnitude {
    struct Params {};
    struct Ports {
        Ref<VectorGrid> vectors;
        Ref<FloatGrid> magnitude;
    };
    static void run(const Params&, Ports& io, Context& context) {
        require_collocation_fits(*io.vectors, context.memory_budget());
        io.magnitude = magnitude_field(io.vectors);
    }
};

}  // namespace

FloatGrid::Ptr magnitude_field(const Ref<VectorGrid>& vectors) {
    const auto out = map_values<FloatGrid>(*collocated(vectors), vectors->background().length(), [](const openvdb::Vec3s& value) { return value.length(); });
    out->setName("magnitude of " + vectors->getName());
    return out;
}

NodeType field_magnitude() {
    return Declare<FieldMagnitude>("field.magnitude", "The length of each vector: speed from velocity.")
        .input("vectors", &FieldMagnitude::Ports::vectors, "Velocity or any other vectors; staggered grids are collocated.")
        .output("magnitude", &FieldMagnitude::Ports::magnitude, "Length, in the unit of `vectors`, on their active voxels.")
        .in_place();
}

}  // namespace fluidcarve
