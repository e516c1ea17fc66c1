#pragma once

#include "carve/points/points.h"
#include "carve/volume/volume.h"

#include <openvdb/Types.h>

#include <functional>
#include <string>

namespace fluidcarve {

/// The velocities that move points.
struct PointMotion {
    std::string velocity;  ///< name of the attribute, see velocity_name(); empty: none
    double scale = 0;      ///< displacement between the two frames at a velocity of 1, world units
};

/// The points of a volume's grid. @throws Failure if the grid is damaged
Points points_in(const VolumeGrid& grid);

/// A share, from 0 to 1, at a world position.
using ShareAt = std::function<double(const openvdb::Vec3d&)>;

/// The points at a moment between two frames, which may differ from place to place. A point that
/// both frames have, by its `id`, moves from its one position to the other along its velocities. A
/// point that only one of them has appears, or vanishes, at a moment of its own, so that the
/// number of points changes evenly. Without ids, the points are those of the nearer frame, moved
/// along their velocities. Attributes are those of the nearer frame; velocities of points that
/// both have lie between. A velocity that is not finite counts as 0.
/// @param share   of the way from `a` to `b`, where a point is in its frame, or in `a` if both have
///   it
/// @param nearer  `a` or `b`: shown alone if the two have other attributes
Points points_between(const Points& a, const Points& b, const ShareAt& share, const Points& nearer,
                      const PointMotion& motion);
/// The same with one moment for all places.
Points points_between(const Points& a, const Points& b, double share, const PointMotion& motion);

/// Mixes the points of two frames, by a share of the second that differs from place to place. Each
/// point changes over at a share of its own, so that the density stays. A point that both frames
/// have, by its `id`, takes the share at its position in the first, and is never shown twice. If
/// the attributes differ, all points are those of the nearer frame.
/// @param share   at a world position, from 0 to 1
/// @param nearer  `a` or `b`
Points points_mixed(const Points& a, const Points& b, const ShareAt& share, const Points& nearer);

/// The scale at which the velocities of two frames best predict the displacements of their points.
/// With ids by least squares; else the scale at which moved points come nearest to points of the
/// other frame.
/// @return displacement at a velocity of 1, world units; 0: nothing moves, or the motion is
///   unknown
double point_scale(const Points& a, const Points& b, const std::string& velocity);

}  // namespace fluidcarve
