#pragma once

#include "carve/points/points.h"
#include "carve/time/points_between.h"
#include "carve/volume/volume.h"

#include <functional>

namespace fluidcarve {

/// A rate of time at a world position: frames of the source per frame.
using RateAt = std::function<double(const openvdb::Vec3d&)>;

/// Multiplies all velocities by the local rate of time: grids of vectors, also those stored as
/// three grids (Triplet), and the velocities of points (velocity_name).
Volume paced(const Volume& volume, const RateAt& rate);
/// The same of points.
Points paced(const Points& points, const RateAt& rate);

}  // namespace fluidcarve
