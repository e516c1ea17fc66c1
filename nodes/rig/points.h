#pragma once

#include "graph/types/node_type.h"
#include "nodes/rig/rig.h"

#include <map>

namespace fluidcarve {

/// The points at a frame, from those stated for some: between two of them linearly, before and behind all as the nearest.
/// @param keys  by frame, at least one
/// @throws Failure where two keys to mix differ in their number of points
std::vector<openvdb::Vec3d> points_at(const std::map<int, std::vector<openvdb::Vec3d>>& keys, int frame);

/// `rig.points`: a rig from points that the pipeline states.
NodeType rig_points();

}  // namespace fluidcarve
