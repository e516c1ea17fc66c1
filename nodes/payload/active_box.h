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

/// The payload type `active_box`.
PayloadType active_box_type();

}  // namespace fluidcarve
