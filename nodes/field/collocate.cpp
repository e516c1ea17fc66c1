#include "nodes/field/collocate.h"

#include "graph/text/problem.h"
#include "nodes/field/stencil.h"

#include <fmt/format.h>

namespace fluidcarve {
namespace {

struct FieldCollocate {
    struct Params {};
    struct Ports {
        Ref<VectorGrid> velocity, collocated;
    };
    static void run(const Params&, Ports& io, Context& context) {
        require_collocation_fits(*io.velocity, context.memory_budget());
        io.collocated = collocated(io.velocity);
    }
};

}  // namespace

Ref<VectorGrid> collocated(const Ref<VectorGrid>& velocity) {
    if (velocity->getGridClass() != openvdb::GRID_STAGGERED) return velocity;
    if (!velocity->transform().isLinear() || !velocity->transform().baseMap()->getAffineMap()->isScaleTranslate())
        throw Failure(fmt::format("grid '{}' is staggered on turned voxels, so that nobody can tell which way its components point; store it collocated",
                                  velocity->getName()));
    const auto out = map_stencil<VectorGrid>(*velocity, velocity->background(), [](auto& faces, const openvdb::Coord& at) {
        const auto& low = faces.getValue(at);
        return 0.5f * openvdb::Vec3s(low[0] + faces.getValue(at.offsetBy(1, 0, 0))[0],  //
                                     low[1] + faces.getValue(at.offsetBy(0, 1, 0))[1],  //
                                     low[2] + faces.getValue(at.offsetBy(0, 0, 1))[2]);
    });
    out->setName(velocity->getName());
    out->setVectorType(velocity->getVectorType());
    return out;
}

void require_collocation_fits(const VectorGrid& velocity, std::uint64_t budget) {
    if (velocity.getGridClass() == openvdb::GRID_STAGGERED) require_stencil_fits(velocity, sizeof(openvdb::Vec3s), budget);
}

NodeType field_collocate() {
    return Declare<FieldCollocate>("field.collocate", "Moves a staggered velocity from the voxels' faces to their centres.")
        .input("velocity", &FieldCollocate::Ports::velocity, "Velocity, any unit. A grid that is not staggered passes unchanged.")
        .output("velocity", &FieldCollocate::Ports::collocated, "The mean of each voxel's two faces along each axis, on the active voxels of `velocity`.")
        .kept();
}

}  // namespace fluidcarve
