#pragma once

#include <openvdb/math/Transform.h>

namespace fluidcarve {

/// The least edge of a voxel, in world units. OpenVDB refuses transforms of voxels whose volume is
/// below 3e-15.
constexpr double least_voxel = 2e-5;

/// The transform of cubes along the world's axes, one of them with its centre at the origin.
/// @param edge  world units
/// @throws Failure if it is below `least_voxel`
openvdb::math::Transform::Ptr cubes_of(double edge);

/// The shortest edge of a voxel, world units.
double shortest_edge(const openvdb::math::Transform& transform);

}  // namespace fluidcarve
