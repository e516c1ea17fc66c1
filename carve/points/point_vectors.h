#pragma once

#include "carve/points/points.h"

#include <openvdb/Types.h>

#include <string>
#include <vector>

namespace fluidcarve {

/// The attribute that holds the velocities of points: `v`, `vel`, `velocity`, or the only one
/// whose name ends with `velocity`. In a PLY file it is three columns, such as `vx`, `vy`, `vz` or
/// `velocity_x`, `velocity_y`, `velocity_z`. Empty if there is none.
std::string velocity_name(const Points& points);

/// A vector of each point, in the order of the points.
/// @param name  an attribute of three floats, or three columns of a PLY file
/// @return empty if the points have no such attribute
std::vector<openvdb::Vec3d> vectors_of(const Points& points, const std::string& name);

/// The points with an attribute's vectors replaced; all else stays bit for bit.
/// @param name     as for vectors_of(); the points must have this attribute
/// @param vectors  one per point
Points with_vectors(const Points& points, const std::string& name,
                    const std::vector<openvdb::Vec3d>& vectors);

}  // namespace fluidcarve
