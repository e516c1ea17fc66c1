#pragma once

#include <openvdb/Types.h>

#include <cstdint>

namespace fluidcarve {

/// A point of a changed point set: the source point that it is, or is a copy of, and its new
/// position.
struct PointImage {
    std::uint32_t source = 0;      ///< index of the source point
    bool moved = false;            ///< false: it keeps its position bit for bit
    openvdb::Vec3d position{0.0};  ///< new world position, if it moved
};

}  // namespace fluidcarve
