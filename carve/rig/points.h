#pragma once

#include "carve/rig/rig.h"

#include <map>
#include <vector>

namespace fluidcarve {

/// The points of a moving rig in one frame. Between two keys they are interpolated linearly; before
/// the first and after the last key they stand still.
/// @param keys  points by frame number, at least one key
/// @return world units
/// @throws Failure if the two keys around the frame have different numbers of points
std::vector<openvdb::Vec3d> points_at(const std::map<int, std::vector<openvdb::Vec3d>>& keys,
                                      int frame);

}  // namespace fluidcarve
