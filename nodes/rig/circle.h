#pragma once

#include "graph/types/node_type.h"
#include "nodes/rig/rig.h"

#include <array>

namespace fluidcarve {

/// A circle or oval that runs clockwise seen from the tip of its normal: `u` points outwards, `v` along the normal.
/// @param normal  not zero
/// @param radii   along the world's x made orthogonal to the normal (y, if that is along x), and across; above 0
/// @param start   radians from the first of these directions, in the direction of running
Rig circle_rig(const openvdb::Vec3d& center, const openvdb::Vec3d& normal, const std::array<double, 2>& radii, double start);

/// `rig.circle`
NodeType rig_circle();

}  // namespace fluidcarve
