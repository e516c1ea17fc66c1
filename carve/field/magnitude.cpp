#include "carve/field/magnitude.h"

#include "carve/base/values.h"
#include "carve/field/collocate.h"
#include "carve/field/stencil.h"

namespace fluidcarve {

FloatGrid::Ptr magnitude_field(const Ref<VectorGrid>& vectors) {
    const auto out =
        map_values<FloatGrid>(*collocated(vectors), vectors->background().length(),
                              [](const openvdb::Vec3s& value) { return value.length(); });
    out->setName("magnitude of " + vectors->getName());
    return out;
}

}  // namespace fluidcarve
