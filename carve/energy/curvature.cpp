#include "carve/energy/curvature.h"

#include "carve/field/curvature.h"
#include "carve/field/stencil.h"

#include <cmath>

namespace fluidcarve {

FloatGrid::Ptr curvature_energy(const FloatGrid& surface, float gain) {
    const auto out =
        map_values<FloatGrid>(*curvature_field(surface), 0.0f,
                              [gain](float curvature) { return gain * std::abs(curvature); });
    out->setName("curvature of " + surface.getName());
    return out;
}

}  // namespace fluidcarve
