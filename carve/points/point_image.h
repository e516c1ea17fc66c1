#pragma once

#include <openvdb/Types.h>

#include <cstdint>

namespace fluidcarve {

/// A point of a changed point set: the index of its source point, and its new position. Copies of
/// a point have the same source.
struct PointImage {
    std::uint32_t source = 0;      ///< index of the source point
    bool moved = false;            ///< false: the position stays bit for bit
    openvdb::Vec3d position{0.0};  ///< new world position, if it moved
};

}  // namespace fluidcarve
