#pragma once

#include "graph/types/payload.h"

#include <openvdb/openvdb.h>

#include <string>

namespace fluidcarve {

/// Where a grid's active voxels are in one frame.
struct ActiveBox {
    std::string name;  ///< the grid's
    openvdb::math::Transform::ConstPtr transform;
    openvdb::CoordBBox voxels;  ///< empty: none is active
};

/// The payload type `active_box`.
PayloadType active_box_type();

}  // namespace fluidcarve
