#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

/// What energy.remap does with the place `t` of a value in its range, 0 at the low end and 1 at the high end.
struct RemapCurve {
    Interval to{0, 1};    ///< t = 0 becomes the low end, t = 1 the high end
    double gamma = 1;     ///< t ^ gamma: below 1 lifts low values, above 1 lowers them; needs `clamp` unless 1
    bool clamp = true;    ///< t is held within [0, 1]
    bool invert = false;  ///< `to` the other way round: t = 0 becomes its high end
};

/// A field's values brought into another interval.
/// @param field  any unit
/// @param range  what becomes `to`; if low >= high, all of the field counts as its low end
/// @return on the active voxels of `field`; elsewhere its background, remapped as well
/// @throws Failure naming the grid and voxel if an active value is not finite
FloatGrid::Ptr remapped_energy(const FloatGrid& field, const Interval& range, const RemapCurve& curve);

NodeType energy_remap();

}  // namespace fluidcarve
