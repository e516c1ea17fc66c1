#pragma once

#include "carve/points/points.h"
#include "carve/time/points_between.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// Multiplies all velocities by how fast time goes where they are: grids of vectors, also those in
/// three parts (Triplet), and those of points (velocity_name).
/// @param rate  frames of the source per frame at a world position
Volume paced(const Volume& volume, const ShareAt& rate);
/// The same of points.
Points paced(const Points& points, const ShareAt& rate);

}  // namespace fluidcarve
