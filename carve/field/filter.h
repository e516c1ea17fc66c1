#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <array>
#include <utility>

namespace fluidcarve {

/// The filters of filtered_field.
enum class FilterMode {
    mean,      ///< mean of a cube with sides of 2 width + 1 voxels
    median,    ///< median of that cube: removes features thinner than half of it, keeps edges
    gaussian,  ///< four means in a row: within 5 % of a Gaussian with variance 4 width (width + 1)
               ///< / 3, in voxels squared
};

template <>
struct ChoiceNames<FilterMode> {
    static constexpr std::array names = {std::pair{"mean", FilterMode::mean},
                                         std::pair{"median", FilterMode::median},
                                         std::pair{"gaussian", FilterMode::gaussian}};
};

/// Smooths a field with openvdb::tools::Filter.
/// @param field       any unit. Inactive voxels count with their stored value, and keep it
/// @param width       voxels, >= 1
/// @param iterations  how often the filter is applied, >= 1
/// @return same unit, active voxels, class, metadata and transform. A constant neighbourhood stays
///   constant, up to float rounding
/// @throws Failure naming the grid and the voxel if a value that is not finite lies on or within
///   `width` voxels of an active voxel
FloatGrid::Ptr filtered_field(const FloatGrid& field, FilterMode mode, int width, int iterations);

}  // namespace fluidcarve
