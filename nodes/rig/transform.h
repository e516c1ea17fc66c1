#pragma once

#include "graph/types/node_type.h"
#include "nodes/rig/rig.h"

namespace fluidcarve {

/// Each point becomes the mean of itself and its neighbours, `times` over; the ends of an open rig stay. A circle becomes
/// its points.
Rig smoothed(const Rig& rig, int times);
/// `pivot + scale (p - pivot) + translate` of each point; `scale` above 0.
Rig moved(const Rig& rig, double scale, const openvdb::Vec3d& pivot, const openvdb::Vec3d& translate);
/// An open rig that goes on straight beyond both ends. @param by  world units, above 0
Rig extended(const Rig& rig, double by);

/// `rig.transform`: a rig changed by hand (paper 3.4).
NodeType rig_transform();

}  // namespace fluidcarve
