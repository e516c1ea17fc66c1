#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <vector>

namespace fluidcarve {

/// How the weight of a region is combined with the energy `E`.
enum class WeightMode {
    assign,  ///< `weight * (1 + E) / 2`: mainly the weight counts, the energy only within a region;
             ///< also raises empty space
    multiply,  ///< `weight * E`
};

/// A region and its weight. Where regions overlap, the later one counts.
struct WeightedRegion {
    Ref<MaskGrid> mask;
    float weight = 1;
};

/// Weights an energy by regions (paper 5.2: with empty 0.8, smoke 0.15 and flame 0.05, seams go
/// through the flame first).
/// @param energy   0 to 1 in mode `assign`, so that regions do not mix
/// @param outside  weight outside of all regions
/// @return energy on the voxels that are active in `energy` or any mask; the background is that of
///   `energy` with weight `outside`
/// @throws Failure naming two grids with different transforms
FloatGrid::Ptr weighted_energy(const FloatGrid& energy, const std::vector<WeightedRegion>& regions,
                               float outside, WeightMode mode);

}  // namespace fluidcarve
