#pragma once

#include "carve/rig/rig.h"

#include <array>

namespace fluidcarve {

/// A circle or oval that runs clockwise, seen from the tip of its normal. `u` points outwards, `v`
/// along the normal.
/// @param center  world units
/// @param normal  not zero
/// @param radii   world units, above 0: along the world's x made orthogonal to the normal (y, if
///   the normal is along x), and across
/// @param start   angle of the first plane, radians, from the direction of the first radius in
///   running direction
Rig circle_rig(const openvdb::Vec3d& center, const openvdb::Vec3d& normal,
               const std::array<double, 2>& radii, double start);

}  // namespace fluidcarve
