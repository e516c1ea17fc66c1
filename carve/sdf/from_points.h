#pragma once

#include "carve/points/points.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

/// How points are converted to a surface.
struct Splat {
    double radius = 1.5;    ///< radius of the ball around each point, voxels
    int smoothing = 0;      ///< number of passes of a 3 x 3 x 3 mean filter over the surface
    double half_width = 3;  ///< half width of the narrow band, voxels
};

/// Signed distances to the union of balls around points, negative inside, in a narrow band: a level
/// set "surface", world units. Without points it is outside everywhere.
/// @param transform  of the grid; must have cubic voxels
/// @throws Failure if a point is too far from the grid's origin
FloatGrid::Ptr sdf_of_points(const Points& points, const openvdb::math::Transform& transform,
                             const Splat& splat);

}  // namespace fluidcarve
