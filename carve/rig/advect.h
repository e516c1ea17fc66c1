#pragma once

#include "carve/volume/volume.h"

#include <vector>

namespace fluidcarve {

/// Points spread evenly in a ball, the same in every call. Their centroid is the ball's centre.
/// @param radius  world units
std::vector<openvdb::Vec3d> points_in_ball(const openvdb::Vec3d& center, double radius, int count);

/// Moves points with the flow, in steps of at most a voxel (Runge-Kutta, fourth order). Points
/// that start in, or reach, inactive velocity are removed: they would stand still and hold the
/// centroid back. The others keep their order.
/// @param velocity  world units that a point moves per unit of `duration`; staggered or not
/// @param duration  above 0
/// @throws Failure naming the grid and position if a value is not finite
void advect(std::vector<openvdb::Vec3d>& points, const VectorGrid& velocity, double duration);

}  // namespace fluidcarve
