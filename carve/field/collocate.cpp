#include "carve/field/collocate.h"

#include "carve/base/failure.h"
#include "carve/base/values.h"
#include "carve/field/stencil.h"

#include <fmt/format.h>

#include <cstdint>

namespace fluidcarve {

Ref<VectorGrid> collocated(const Ref<VectorGrid>& velocity) {
    if (velocity->getGridClass() != openvdb::GRID_STAGGERED) return velocity;
    if (!velocity->transform().isLinear() ||
        !velocity->transform().baseMap()->getAffineMap()->isScaleTranslate())
        throw Failure(
            fmt::format("grid '{}' is staggered on turned voxels, so that nobody can tell which "
                        "way its components point; store it collocated",
                        velocity->getName()));
    const auto out = map_stencil<VectorGrid>(
        *velocity, velocity->background(), [](auto& faces, const openvdb::Coord& at) {
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
    if (velocity.getGridClass() == openvdb::GRID_STAGGERED)
        require_stencil_fits(velocity, sizeof(openvdb::Vec3s), budget);
}

}  // namespace fluidcarve
