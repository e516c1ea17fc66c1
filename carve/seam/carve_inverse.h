#pragma once

#include "carve/seam/carve_map.h"

namespace fluidcarve {

/// Where a step moves a point of its lattice (METHOD 6): the coordinate `u*` along the axis with
/// `M(u*, v, w) = u`. `M` rises along the axis by at least 1/2 per vertex and is linear between
/// entries, so the result is exact, continuous and rising. A point that a removal takes at an end
/// of the axis goes to that end. Points outside CarveStep::holds() stay.
/// @param at  coordinates in the space before the step, vertices
/// @return carved coordinate along the axis, vertices
double carved_coordinate(const CarveStep& step, const openvdb::Vec3d& at);

/// Where all steps of a map, in order, move a point of the lattice. Points that do not move stay
/// bit for bit.
/// @param at  lattice index coordinates
openvdb::Vec3d carved_coordinates(const CarveMap& map, openvdb::Vec3d at);

}  // namespace fluidcarve
