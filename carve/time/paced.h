#pragma once

#include "carve/points/points.h"
#include "carve/time/points_between.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// Multiplies all velocities by the local rate of time: grids of vectors, also those stored as
/// three grids (Triplet), and the velocities of points (velocity_name).
/// @param rate  frames of the source per frame at a world position
Volume paced(const Volume& volume, const ShareAt& rate);
/// The same of points.
Points paced(const Points& points, const ShareAt& rate);

}  // namespace fluidcarve
