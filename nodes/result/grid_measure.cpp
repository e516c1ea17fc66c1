#include "nodes/result/grid_measure.h"

#include "carve/field/extent.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace fluidcarve {
namespace {

using openvdb::Index;
using openvdb::Vec3d;

struct Magnitude {
    static constexpr bool of_all = false;  ///< whether inactive voxels count, too
    double operator()(double value) const {
        const double size = std::abs(value);
        return size <= std::numeric_limits<float>::max() ? size : 0;
    }
};

/// The share of a voxel that is inside a level set, if its surface were flat and parallel to a
/// face.
struct Inside {
    static constexpr bool of_all = true;
    double voxel;  ///< edge, world units
    double operator()(double distance) const {
        const double share = 0.5 - distance / voxel;
        return share > 0 ? std::min(share, 1.0) : 0;
    }
};

/// Amounts of voxels, summed.
struct AmountSums {
    double sum = 0, highest = 0;
    Vec3d moment{0};  ///< sum of amount times position, index units

    AmountSums& operator+=(const AmountSums& other) {
        sum += other.sum;
        moment += other.moment;
        highest = std::max(highest, other.highest);
        return *this;
    }
};

template <class Leaf, class Amount>
AmountSums of_leaf(const Leaf& leaf, const Amount& amount) {
    const auto* const values = leaf.buffer().data();
    AmountSums out;
    for (Index x = 0; x < 8; ++x) {
        const auto on = Amount::of_all ? ~openvdb::Index64{0}
                                       : leaf.getValueMask().template getWord<openvdb::Index64>(x);
        if (on == 0) continue;
        for (Index y = 0; y < 8; ++y) {
            double row = 0, along = 0;
            for (auto left = static_cast<unsigned>(on >> (8 * y) & 255); left != 0;
                 left &= left - 1) {
                const auto z = static_cast<Index>(std::countr_zero(left));
                const double each = amount(static_cast<double>(values[64 * x + 8 * y + z]));
                row += each;
                along += each * z;
                out.highest = std::max(out.highest, each);
            }
            out.sum += row;
            out.moment += Vec3d(row * x, row * y, along);
        }
    }
    out.moment += leaf.origin().asVec3d() * out.sum;
    return out;
}

template <class Tiles, class Amount>
AmountSums of_tiles(Tiles tile, const Amount& amount) {
    AmountSums out;
    tile.setMaxDepth(Tiles::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        const double each = amount(static_cast<double>(*tile));
        if (each == 0) continue;
        openvdb::CoordBBox box;
        tile.getBoundingBox(box);
        const double sum = each * static_cast<double>(box.volume());
        out += {sum, each, box.getCenter() * sum};
    }
    return out;
}

/// Adds in a fixed order, so that the result does not depend on the threads.
template <class Tree, class Amount>
AmountSums amounts(const Tree& tree, const Amount& amount) {
    constexpr std::size_t leaves_at_once = 64;
    const openvdb::tree::LeafManager<const Tree> leaves(tree);
    auto out = tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, leaves.leafCount(), leaves_at_once), AmountSums{},
        [&](const tbb::blocked_range<std::size_t>& range, AmountSums sums) {
            for (auto n = range.begin(); n < range.end(); ++n)
                sums += of_leaf(leaves.leaf(n), amount);
            return sums;
        },
        [](AmountSums a, const AmountSums& b) { return a += b; });
    if constexpr (Amount::of_all) out += of_tiles(tree.cbeginValueAll(), amount);
    else out += of_tiles(tree.cbeginValueOn(), amount);
    return out;
}

template <class Grid>
GridMeasure measure_of(const Grid& grid) {
    const bool level_set = grid.getGridClass() == openvdb::GRID_LEVEL_SET;
    const auto sums = level_set ? amounts(grid.tree(), Inside{voxel_edge(grid)})
                                : amounts(grid.tree(), Magnitude{});
    GridMeasure out;
    out.mass = sums.sum * std::abs(grid.transform().voxelVolume());
    if (!level_set) out.highest = sums.highest;
    if (sums.sum > 0) out.centre = grid.transform().indexToWorld(sums.moment / sums.sum);
    if (const auto voxels = active_box(grid); !voxels.empty())
        out.box = grid.transform().indexToWorld(openvdb::BBoxd(
            voxels.min().asVec3d() - Vec3d(0.5), voxels.max().asVec3d() + Vec3d(0.5)));
    return out;
}

}  // namespace

std::optional<GridMeasure> measured(const openvdb::GridBase& grid) {
    if (grid.isType<openvdb::FloatGrid>())
        return measure_of(static_cast<const openvdb::FloatGrid&>(grid));
    if (grid.isType<openvdb::DoubleGrid>())
        return measure_of(static_cast<const openvdb::DoubleGrid&>(grid));
    return std::nullopt;
}

double voxel_edge(const openvdb::GridBase& grid) {
    return std::cbrt(std::abs(grid.transform().voxelVolume()));
}

}  // namespace fluidcarve
