#pragma once

#include "carve/seam/vertex_range.h"
#include "carve/seam/window.h"
#include "carve/solver/task/params.h"
#include "carve/warp/amount.h"
#include "graph/types/param.h"

#include <array>

namespace fluidcarve {

class NodeCheck;

/// The parameters of `warp.solve`. Its declaration says what each means.
struct WarpParams {
    Axis axis = Axis::u;
    Auto<WarpAmount> amount;  ///< nothing: that of `amount_file`
    InputPath amount_file;
    bool rest = false;
    Auto<VertexRange> window;
    Auto<PairRanges> pair_window;
    bool static_ = false;
    Anchor anchor;
    float field_weight = 0.1f;
    float evenness = 0.3f;
    float empty = 0.8f;
    float stiffness = 0.25f;
    float stiffness_time = 1;
    Auto<int> factor;
};

/// Finds parameters that contradict each other.
void check_params(const WarpParams& params, NodeCheck& check);

/// The amount that is stated, or that of the file; with `rest` as if nothing were carved before.
/// @throws Failure (input) as read_amounts(), or if a static warp is to change over time
WarpAmount amount_of(const WarpParams& params);

/// Requires that the parameters fit a lattice. Masks may leave less room.
/// @param amount  amount_of(params)
/// @param shape   I, J, K of the space that is carved
/// @param frames  frame numbers
/// @param space   what messages say after "vertices", as of once_carved()
/// @throws Failure if a window, the anchor or the amount leaves the lattice, or if a ring's amounts
///   do not meet
void require_fits(const WarpParams& params, const WarpAmount& amount,
                  const std::array<int, 3>& shape, bool closed, const std::vector<int>& frames,
                  const std::string& space);

/// The window, or all vertices.
Window window_of(const Auto<VertexRange>& window, int size);

/// The place of a plane along the lattice, 0 to 1, as curves count it. In a ring 1 is plane 0
/// again.
double place_along(int k, int slices, bool closed);

}  // namespace fluidcarve
