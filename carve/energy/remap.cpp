#include "carve/energy/remap.h"

#include "carve/base/values.h"
#include "carve/field/stencil.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {

FloatGrid::Ptr remapped_energy(const FloatGrid& field, const Interval& range,
                               const RemapCurve& curve) {
    const auto remap = [&](float value) {
        double t = range.low < range.high ? (value - range.low) / (range.high - range.low) : 0;
        if (curve.clamp) t = std::clamp(t, 0.0, 1.0);
        if (curve.gamma == 2) t *= t;
        else if (curve.gamma != 1) t = std::pow(t, curve.gamma);
        return static_cast<float>(curve.invert ? std::lerp(curve.to.high, curve.to.low, t)
                                               : std::lerp(curve.to.low, curve.to.high, t));
    };
    const auto out = map_values<FloatGrid>(field, remap(field.background()), remap);
    out->setName("remap of " + field.getName());
    return out;
}

}  // namespace fluidcarve
