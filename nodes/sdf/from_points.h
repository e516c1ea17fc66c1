#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"
#include "nodes/points/points.h"

namespace fluidcarve {

/// How points become a surface.
struct Splat {
    double radius = 1.5;    ///< of the ball around each point, voxels
    int smoothing = 0;      ///< passes of a 3^3 mean filter over the surface
    double half_width = 3;  ///< of the narrow band, voxels
};

/// The signed distance to the union of balls around points, negative inside, in a narrow band: a level set, in world units. Without points
/// it is outside everywhere.
/// @param transform  of the grid to make; its voxels are cubes
FloatGrid::Ptr sdf_of_points(const Points& points, const openvdb::math::Transform& transform, const Splat& splat);

/// `sdf.from_points {points, like | voxel_size, radius}`: the surface of particles.
NodeType sdf_from_points();

}  // namespace fluidcarve
