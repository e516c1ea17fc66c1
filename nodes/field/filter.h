#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

namespace fluidcarve {

enum class FilterMode {
    mean,      ///< of the cube of 2 width + 1 voxels
    median,    ///< of that cube; removes what is thinner than half of it, keeps edges
    gaussian,  ///< four means, one after the other: within 5 % of a Gaussian of variance 4 width (width + 1) / 3
};

template <>
struct ChoiceNames<FilterMode> {
    static constexpr std::array names = {std::pair{"mean", FilterMode::mean}, std::pair{"median", FilterMode::median},
                                         std::pair{"gaussian", FilterMode::gaussian}};
};

/// A smoother field, by openvdb::tools::Filter.
/// @param field  any unit. Beyond its active voxels the values that it holds count, and stay
/// @param width  voxels, >= 1
/// @param iterations  >= 1; how often the filter is applied
/// @return same unit, active voxels, class, metadata and transform; where all values within reach are alike, so is the result,
///         to the rounding of a float
/// @throws Failure naming the grid and voxel if a value that is not finite lies on or within `width` of an active voxel
FloatGrid::Ptr filtered_field(const FloatGrid& field, FilterMode mode, int width, int iterations);

NodeType field_filter();

}  // namespace fluidcarve
