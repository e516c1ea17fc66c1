#pragma once

#include "nodes/rig/rig.h"

#include <optional>
#include <vector>

namespace fluidcarve {

/// Points of a path at equal straight distances (METHOD 2).
struct Resampled {
    std::vector<openvdb::Vec3d> points;
    std::vector<openvdb::Vec3d> chords;  ///< unit; from each point to the next, of a closed rig back to the first too
    double step = 0;                     ///< the distance, world units
};

/// Each point is the first of the path at distance `step` from the one before. Of an open rig `step` is the spacing, and
/// what is left at its end is less than a step; a closed one takes the number of steps nearest to the spacing, and the
/// `step` that closes it.
/// @param rig     without a rig_fault
/// @param planes  how many points instead; their step then spans the whole of an open rig
/// @throws Failure if there are fewer than 2 points (3 if closed), more than a lattice may have, or no such step
Resampled resampled(const Rig& rig, double spacing, std::optional<int> planes = std::nullopt);

}  // namespace fluidcarve
