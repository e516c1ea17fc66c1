#pragma once

#include "carve/base/frame_store.h"
#include "carve/seam/warp.h"
#include "carve/solver/costs/energy_volume.h"
#include "carve/solver/costs/prices.h"

namespace fluidcarve {

/// How stiff a vertex is against squeezing and shearing (METHOD 11 "Weights").
struct WarpWeights {
    float field = 0.1f;  ///< stiffness that an edge of typical size adds, as a share of that of the
                         ///< typical energy
    float evenness = 0.3f;  ///< stiffness of all content, the same way
    float empty = 0.8f;     ///< stiffness of a vertex without content, as a share of the mean
                            ///< stiffness of vertices with content
};

/// The weights of content and empty space are at most this.
inline constexpr float most_ordinary_weight = 32;
/// The weight of a protected vertex, and the least weight of a point that stands for one.
inline constexpr float rigid_weight = 4096;
inline constexpr float least_rigid_weight = 48;
/// The weight of an attracted vertex.
inline constexpr float soft_weight = 1.0f / 256;

/// Finds the weights of a warp's points. A point has the mean of the vertices that are nearest to
/// it, in a static warp over all frames.
/// @param energy   codes as they were sampled, without edges and prices; with a field or not
/// @param typical  of the energy
/// @param stated   how much each part of a vertex's stiffness counts
/// @param warp     says where points stand
/// @param weights  becomes energy codes, laid out as the warp's values
void find_weights(const EnergyVolume& energy, const Typical& typical, const WarpWeights& stated,
                  const Warp& warp, FrameStore& weights);

}  // namespace fluidcarve
