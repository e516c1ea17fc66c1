#include "carve/field/filter.h"

#include "carve/base/values.h"
#include "carve/field/box_mean.h"
#include "carve/field/extent.h"
#include "carve/field/stencil.h"
#include "carve/field/voxel_axes.h"

#include <openvdb/tools/Filter.h>

#include <array>
#include <cmath>
#include <optional>

namespace fluidcarve {

namespace {

using Tree = openvdb::FloatTree;

bool all_finite(const Tree& tree) {
    if (!std::isfinite(tree.background())) return false;
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (!std::isfinite(*tile)) return false;
    const auto finite = [](const Tree::LeafNodeType& leaf) {
        // Only finite values times 0 are 0.
        const auto* const values = leaf.buffer().data();
        float sum = 0;
        for (openvdb::Index n = 0; n < Tree::LeafNodeType::SIZE; ++n) sum += values[n] * 0;
        return sum == 0;
    };
    using Leaves = openvdb::tree::LeafManager<const Tree>;
    const Leaves leaves(tree);
    return tbb::parallel_reduce(
        leaves.leafRange(), true,
        [&](const Leaves::LeafRange& range, bool so_far) {
            for (auto leaf = range.begin(); leaf && so_far; ++leaf) so_far = finite(*leaf);
            return so_far;
        },
        [](bool a, bool b) { return a && b; });
}

/// The lowest active voxel that has a value that is not finite within `width` voxels.
std::optional<openvdb::Coord> lowest_near_not_finite(const Tree& tree, int width) {
    if (all_finite(tree)) return std::nullopt;
    std::optional<openvdb::Coord> lowest;
    const openvdb::tree::ValueAccessor<const Tree> accessor(tree);
    for (auto value = tree.cbeginValueOn(); value; ++value) {
        const auto at = value.getCoord();
        if (lowest && *lowest < at) continue;
        const auto cube =
            value.isVoxelValue() ? padded({at, at}, width) : openvdb::CoordBBox(at, at);
        for (auto near = cube.begin(); near; ++near)
            if (!std::isfinite(accessor.getValue(*near))) {
                lowest = at;
                break;
            }
    }
    return lowest;
}

/// The order of axes of openvdb::tools::Filter, for the world's axes.
std::array<int, 3> filter_order(const openvdb::math::Transform& transform) {
    if (!transform.isLinear()) return {0, 2, 1};
    const VoxelAxes own(transform);
    return {own.nearest(0), own.nearest(2), own.nearest(1)};
}

/// Largest distance from which a voxel's value is computed, voxels.
int reach(FilterMode mode, int width, int iterations) {
    return width * iterations * (mode == FilterMode::gaussian ? 4 : 1);
}

}  // namespace

FloatGrid::Ptr filtered_field(const FloatGrid& field, FilterMode mode, int width, int iterations) {
    const auto out = field.deepCopy();
    // The filter's own setProcessTiles only compares values beyond a tile's faces, but a cube also
    // reaches over its edges and corners.
    open_tile_borders(out->tree(), reach(mode, width, iterations));
    const auto refuse = [&](int near) {
        if (const auto lowest = lowest_near_not_finite(out->tree(), near))
            refuse_not_finite(field, *lowest);
    };
    refuse(width);
    openvdb::tools::Filter<FloatGrid> filter(*out);
    // A Gaussian is four means in a row, as in openvdb::tools::Filter.
    const bool narrow = width <= most_box_width;
    if (mode == FilterMode::median) filter.median(width, iterations);
    else if (narrow)
        box_mean(out->tree(), width, mode == FilterMode::gaussian ? 4 * iterations : iterations,
                 filter_order(field.transform()));
    else if (mode == FilterMode::gaussian) filter.gaussian(width, iterations);
    else filter.mean(width, iterations);
    refuse(0);
    out->setName(choice_text(mode) + " of " + field.getName());
    return out;
}

}  // namespace fluidcarve
