#pragma once

#include <openvdb/Types.h>

#include <cstdint>

namespace fluidcarve {

/// A point of a changed list: which one of the source it is, or is a copy of.
struct PointImage {
    std::uint32_t source = 0;
    bool moved = false;            ///< false: it stays where it is, bit for bit
    openvdb::Vec3d position{0.0};  ///< world, if it moved
};

}  // namespace fluidcarve
