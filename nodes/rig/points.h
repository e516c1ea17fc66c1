#pragma once

#include "graph/types/node_type.h"
#include "nodes/rig/rig.h"

#include <map>

namespace fluidcarve {

/// The points of a moving rig in one frame. Between two keys they are interpolated linearly; before the first and after the last key they
/// stand still.
/// @param keys  points by frame number, at least one key
/// @return world units
/// @throws Failure if the two keys around the frame have different numbers of points
std::vector<openvdb::Vec3d> points_at(const std::map<int, std::vector<openvdb::Vec3d>>& keys, int frame);

/// `rig.points`: a rig through points stated in the pipeline.
NodeType rig_points();

}  // namespace fluidcarve
