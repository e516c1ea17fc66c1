#include "carve/field/active_range.h"

#include "carve/field/stencil.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

Interval joined(const Interval& a, const Interval& b) {
    return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

Interval active_range(const FloatGrid& grid) {
    using Leaves = openvdb::tree::LeafManager<const openvdb::FloatTree>;
    const auto extend = [](Interval range, auto value) {
        for (; value; ++value) {
            const double v = *value;
            // An infinite range marks a value that is not finite; the place is found below.
            range = std::isfinite(v) ? joined(range, {v, v})
                                     : Interval{empty_range.high, empty_range.low};
        }
        return range;
    };
    const Leaves leaves(grid.tree());
    auto out = tbb::parallel_reduce(
        leaves.leafRange(), empty_range,
        [&](const Leaves::LeafRange& range, Interval so_far) {
            for (auto leaf = range.begin(); leaf; ++leaf)
                so_far = extend(so_far, leaf->cbeginValueOn());
            return so_far;
        },
        joined);
    auto tiles = grid.cbeginValueOn();
    tiles.setMaxDepth(decltype(tiles)::LEAF_DEPTH - 1);
    out = extend(out, tiles);
    if (std::isinf(out.low) && out.low < out.high) refuse_not_finite(grid, {});
    return out;
}

}  // namespace fluidcarve
