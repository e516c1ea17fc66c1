#pragma once

#include "carve/rig/rig.h"

#include <optional>
#include <vector>

namespace fluidcarve {

/// Points along a path at equal straight distances (METHOD 2).
struct Resampled {
    std::vector<openvdb::Vec3d> points;
    std::vector<openvdb::Vec3d> chords;  ///< unit vectors from each point to the next; of a closed
                                         ///< rig also from the last to the first
    double step = 0;                     ///< distance of neighbouring points, world units
};

/// Resamples a rig. Each point is the first one of the path at straight distance `step` from the
/// point before. In an open rig `step` is the spacing; the rest at the end is shorter than a step.
/// In a closed rig the number of steps comes closest to the spacing, and `step` is adjusted so that
/// the last step closes the rig.
/// @param rig      without a rig_fault()
/// @param spacing  world units
/// @param planes   number of points; nothing: from the spacing. If stated, `step` is adjusted so
///   that the points span an open rig from end to end
/// @throws Failure if there are fewer than 2 points (3 if closed), more than most_vertices, or if
///   no such step exists
Resampled resampled(const Rig& rig, double spacing, std::optional<int> planes = std::nullopt);

}  // namespace fluidcarve
