#pragma once

#include "nodes/seams/carve_map.h"

namespace fluidcarve {

/// Where a step takes a point of its lattice (METHOD 6): the coordinate `u*` along the axis with `M(u*, v, w) = u`. `M` rises
/// along the axis, by at least 1/2 per vertex, and is linear between entries, so this is exact, continuous, and rises too. What
/// a removal takes at either end of the axis goes to the end. Points that the step does not hold stay.
/// @param at  coordinates in the space before the step, vertices
double carved_coordinate(const CarveStep& step, const openvdb::Vec3d& at);

/// Where a point of the lattice goes: through all steps, the first one first. Not changed to the last bit where nothing moves.
/// @param at  lattice index coordinates
openvdb::Vec3d carved_coordinates(const CarveMap& map, openvdb::Vec3d at);

}  // namespace fluidcarve
