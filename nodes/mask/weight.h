#pragma once

#include "graph/types/node_type.h"
#include "nodes/payloads.h"

#include <vector>

namespace fluidcarve {

/// How a region's weight meets the energy `E` there.
enum class WeightMode {
    assign,    ///< `weight * (1 + E) / 2`: the weight decides, the energy orders within it; guards empty space too
    multiply,  ///< `weight * E`
};

/// A region and its weight. Where regions overlap the later one counts.
struct WeightedRegion {
    Ref<MaskGrid> mask;
    float weight = 1;
};

/// Energy by regions (paper 5.2: empty 0.8, smoke 0.15, flame 0.05 send seams through the flame first).
/// @param energy   0 to 1 where `assign` is to keep regions apart
/// @param outside  weight of all that no region covers
/// @return energy on the voxels that are active in `energy` or any mask; its background is that of empty space outside the regions
/// @throws Failure naming two grids if their transforms differ
FloatGrid::Ptr weighted_energy(const FloatGrid& energy, const std::vector<WeightedRegion>& regions, float outside, WeightMode mode);

NodeType mask_weight();

}  // namespace fluidcarve
