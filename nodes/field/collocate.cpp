#include "nodes/field/collocate.h"

#include "nodes/field/stencil.h"

namespace fluidcarve {

Ref<VectorGrid> collocated(const Ref<VectorGrid>& velocity) {
    if (velocity->getGridClass() != openvdb::GRID_STAGGERED) return velocity;
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

}  // namespace fluidcarve
