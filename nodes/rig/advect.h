#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

#include <vector>

namespace fluidcarve {

/// Points spread evenly in a ball, the same in every call, their centroid in its middle.
std::vector<openvdb::Vec3d> points_in_ball(const openvdb::Vec3d& center, double radius, int count);

/// Moves points with the flow, in steps of at most a voxel (Runge-Kutta, fourth order). Those that are, or come, where the
/// velocity is not active are taken out: they would stand there, and hold their middle back. The others keep their order.
/// @param velocity  its values are steps of the points per unit of `duration`, world units; staggered or not
/// @param duration  above 0
/// @throws Failure naming the grid and position if a value is not finite
void advect(std::vector<openvdb::Vec3d>& points, const VectorGrid& velocity, double duration);

/// `rig.advect`: a rig that follows the flow from a seed on (paper 3.4.1).
NodeType rig_advect();

}  // namespace fluidcarve
