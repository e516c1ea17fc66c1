#pragma once

#include <openvdb/Types.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

/// The line in one frame through everything that the flow has carried away from a seed (METHOD 2
/// "Moving rigs").
struct Streakline {
    std::vector<openvdb::Vec3d> points;  ///< the seed, then the centroids of the sets of points,
                                         ///< the latest set first; world units
    std::size_t oldest = 0;              ///< the set whose centroid is the last point
};

/// How moving_lines() shapes the lines of all frames.
struct LineShape {
    double apart = 0;  ///< distance of neighbouring points along a line, world units, above 0
    std::optional<double> length;  ///< length of all lines, world units; nothing: that of the
                                   ///< longest
    int steady = 0;  ///< number of frames on either side that are averaged into a frame's line
};

/// Turns streaklines into lines of one length and one number of points, each starting at the seed:
/// extends them, resamples them in equal steps and averages them over frames (METHOD 2 "Moving
/// rigs").
/// @param streaklines  one per frame, and one more with the sets' positions after the last frame,
///   which may have no points
/// @return one line per frame, world units; empty if no frame has points at least `apart` from
///   each other
/// @throws Failure if a line would have more than a million points
std::vector<std::vector<openvdb::Vec3d>> moving_lines(const std::vector<Streakline>& streaklines,
                                                      const LineShape& shape);

/// Largest distance between corresponding points of two lines, world units. If one line is longer,
/// its further points do not count.
double largest_distance(const std::vector<openvdb::Vec3d>& a, const std::vector<openvdb::Vec3d>& b);

}  // namespace fluidcarve
