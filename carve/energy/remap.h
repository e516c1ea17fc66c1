#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// The curve of energy.remap. It maps `t`, the position of a value in its range: 0 at the low end,
/// 1 at the high end.
struct RemapCurve {
    Interval to{0, 1};  ///< t = 0 becomes the low end, t = 1 the high end
    double gamma = 1;  ///< t ^ gamma: below 1 raises low values, above 1 lowers them; needs `clamp`
                       ///< unless it is 1
    bool clamp = true;    ///< clamps t to [0, 1]
    bool invert = false;  ///< swaps the ends of `to`: t = 0 becomes its high end
};

/// Remaps a field's values to another interval.
/// @param field  any unit
/// @param range  the interval that becomes `to`; if low >= high, every value counts as its low end
/// @return remapped values on the active voxels of `field`; the background is remapped too
/// @throws Failure naming the grid and the voxel if an active value is not finite
FloatGrid::Ptr remapped_energy(const FloatGrid& field, const Interval& range,
                               const RemapCurve& curve);

}  // namespace fluidcarve
