#pragma once

#include <openvdb/openvdb.h>

#include <optional>

namespace fluidcarve {

/// An invalid result at a voxel.
struct WrongValue {
    openvdb::Coord at;
    float value;
};

/// The lowest active voxel, or tile corner, whose value is not finite or below `least`.
std::optional<WrongValue> lowest_wrong(const openvdb::FloatGrid& grid, float least);

}  // namespace fluidcarve
