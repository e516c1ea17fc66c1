#pragma once

#include <openvdb/Types.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

/// The line of all that the flow took along from a seed, as it is in one frame (METHOD 2 "Moving
/// rigs").
struct Streakline {
    std::vector<openvdb::Vec3d> points;  ///< the seed, then the middles of the sets of points, the
                                         ///< latest first; world units
    std::size_t oldest = 0;              ///< the set that the last point is the middle of
};

/// What the lines of all frames become.
struct LineShape {
    double apart = 0;  ///< distance of neighbouring points along a line, world units, above 0
    std::optional<double> length;  ///< of all lines, world units; nothing: that of the longest
    int steady = 0;  ///< frames before and after a frame that have a share in its line
};

/// Lines of one length and one number of points, each from the seed on: streaklines, continued,
/// drawn anew in equal steps, and averaged over frames (METHOD 2 "Moving rigs").
/// @param streaklines  of each frame, and at the end one more: where the sets stand after the last
///   frame; it may have no points
/// @return for each frame, world units; empty if no frame has a line longer than `apart`
/// @throws Failure if a line had more than a million points
std::vector<std::vector<openvdb::Vec3d>> moving_lines(const std::vector<Streakline>& streaklines,
                                                      const LineShape& shape);

/// How far two lines with as many points are apart where they differ most, point by point; world
/// units.
double largest_distance(const std::vector<openvdb::Vec3d>& a, const std::vector<openvdb::Vec3d>& b);

}  // namespace fluidcarve
