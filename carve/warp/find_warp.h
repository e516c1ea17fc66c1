#pragma once

#include "carve/base/frame_store.h"
#include "carve/base/tick.h"
#include "carve/seam/warp.h"
#include "carve/seam/window.h"
#include "carve/warp/warp_system.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Largest share by which an interval may be squeezed, so that vertices stay in order.
inline constexpr double most_squeezed = 0.9;

/// What a warp is to do.
struct WarpTask {
    Window window;                      ///< vertices between which the displacement changes
    std::optional<Window> pair_window;  ///< above `window`: where it goes back to 0
    /// A second pair window, below `window`: each then takes half of the amount, so that the
    /// middle stays.
    std::optional<Window> pair_below;
    /// The window changes by `amount` times these: `[t][k]`, by points of the warp; the greatest is
    /// 1 or -1.
    std::vector<float> factors;
    double amount = 0;  ///< vertices; negative squeezes the window
    WarpStiffness stiffness;
};

/// A column that has too little room for an amount.
struct NoRoom {
    /// The greatest amount for which there is room, vertices, of the sign asked for.
    double possible = 0;
    int lateral = 0, k = 0;
    std::size_t t = 0;          ///< the column with the least room, by vertices
    Window window;              ///< the window with too little room
    bool pair = false;          ///< whether `window` is a pair window
    std::size_t free = 0;       ///< intervals along the axis that are not protected
    std::size_t intervals = 0;  ///< of the window in all
};

/// Looks for a column that has no room for a task: an unprotected interval can give `most_squeezed`
/// of itself.
/// @param weights  as find_weights() gives them
/// @return the column with the least room for its amount; nothing: there is room everywhere
std::optional<NoRoom> no_room(const WarpTask& task, const Warp& warp, const FrameStore& weights);

/// Finds a warp, and sets its scale: its displacements are scale() times its values. As long as
/// nothing is squeezed by more than `most_squeezed`, the warp is linear: its values are the
/// solution for an amount of 1. Else the values are those of this amount: weights are raised where
/// it is too tight, until it is not.
/// @param warp     its values are overwritten; its bounds are not found
/// @param weights  may be raised
/// @param tick     is called between cycles with the share that is done, 0 to 1
/// @return the number of multigrid cycles
int find_warp(const WarpTask& task, Warp& warp, FrameStore& weights, const Tick& tick);

/// The greatest amount of a sign, by bounds() of the warp, up to which a linear warp squeezes
/// nothing by more than `most_squeezed`, vertices from 0 on; infinite if it squeezes nothing.
/// @param sign  1 or -1
double most_linear(const Warp& warp, int sign);

}  // namespace fluidcarve
