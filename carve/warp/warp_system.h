#pragma once

#include "carve/base/frame_store.h"
#include "carve/seam/warp.h"
#include "carve/seam/window.h"

#include <tbb/blocked_range.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace fluidcarve {

/// Some of the columns of a warp.
using WarpColumnRange = tbb::blocked_range<std::size_t>;
/// So many columns of a warp, or fewer, are not divided between threads.
inline constexpr std::size_t warp_columns_per_task = 64;

/// How stiffly a warp resists shear, as a share of how stiffly it resists squeezing.
struct WarpStiffness {
    double space = 0.25;  ///< to neighbours across the axis
    double time = 1;      ///< to the same place in neighbouring frames
};

/// The equations of a warp (METHOD 11): of all displacements with given values at both ends of a
/// window, the one of least
///     sum w (D_u^2 + space (D_v^2 + D_w^2) + time D_t^2)
/// at the points of a warp. Multigrid solves them without a matrix: a line of points along the axis
/// is solved at once, every second line at a time; coarser levels have fewer lines, as long as
/// those of the finest. The result does not depend on the number of threads.
class WarpSystem {
public:
    /// The warp and the weights must outlive this object.
    /// @param warp     holds the given values at the window's ends, and a first guess between them.
    ///   A column whose two ends are 0 stays 0
    /// @param weights  energy codes above 0, one for each value of the warp; not marked ones
    /// @param window   points along the axis; values outside of it are not read
    WarpSystem(Warp& warp, const FrameStore& weights, Window window,
               const WarpStiffness& stiffness);
    ~WarpSystem();
    WarpSystem(const WarpSystem&) = delete;
    WarpSystem& operator=(const WarpSystem&) = delete;

    /// Reads the weights again, after they have changed.
    void update_weights();
    /// Comes closer to the solution, by one multigrid cycle.
    /// @return the greatest change of a value by the cycle's last sweep
    double cycle();

private:
    class Level;
    double cycle(std::size_t n);

    std::vector<std::unique_ptr<Level>> levels_;  ///< from fine to coarse
};

}  // namespace fluidcarve
