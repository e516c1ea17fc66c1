#pragma once

#include "carve/rig/rig.h"

namespace fluidcarve {

/// Smooths a rig: each point becomes the mean of itself and its two neighbours, `times` times. The
/// ends of an open rig stay. A circle becomes a polyline.
Rig smoothed(const Rig& rig, int times);

/// Scales and moves a rig: each point becomes `pivot + scale (p - pivot) + translate`.
/// @param scale  above 0
Rig moved(const Rig& rig, double scale, const openvdb::Vec3d& pivot,
          const openvdb::Vec3d& translate);

/// Extends an open rig straight beyond its ends.
/// @param before, after  added length at its start and its end, world units, at least 0
Rig extended(const Rig& rig, double before, double after);

}  // namespace fluidcarve
