#pragma once

#include "graph/types/payload.h"

#include <openvdb/openvdb.h>

#include <string>

namespace fluidcarve {

/// Box around the active voxels of a grid in one frame.
struct ActiveBox {
    std::string name;  ///< of the grid
    openvdb::math::Transform::ConstPtr transform;
    openvdb::CoordBBox voxels;  ///< index coordinates; empty if no voxel is active
};

/// Converts the active voxels of a grid to the voxels of another transform that hold them.
/// @throws Failure naming the grid and the frame, if they lie too far away
openvdb::CoordBBox voxels_among(const openvdb::math::Transform& first,
                                const openvdb::CoordBBox& voxels,
                                const openvdb::math::Transform& transform, const std::string& name,
                                int frame);

/// The payload type `active_box`.
PayloadType active_box_type();

}  // namespace fluidcarve
