#include "carve/field/box_mean.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace fluidcarve {

namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;
using Leaves = openvdb::tree::LeafManager<Tree>;
constexpr int side = 8, area = side * side;

/// The values of a leaf and of its neighbours before and behind along an axis, as lines along the
/// axis. Values at the same place of all lines are contiguous.
class Lines {
public:
    void read(const openvdb::tree::ValueAccessor<const Tree>& accessor,
              const openvdb::Coord& origin, int axis) {
        for (int block = 0; block < 3; ++block) {
            auto at = origin;
            at[axis] += side * (block - 1);
            auto* const out = all_.data() + block * Leaf::SIZE;
            const auto* const leaf = accessor.probeConstLeaf(at);
            if (!leaf) {
                std::fill_n(out, Leaf::SIZE, accessor.getValue(at));
                continue;
            }
            const auto* const from = leaf->buffer().data();
            if (axis == 0) {
                std::copy_n(from, Leaf::SIZE, out);
            } else {
                for (int x = 0; x < side; ++x)
                    for (int y = 0; y < side; ++y)
                        for (int z = 0; z < side; ++z)
                            out[axis == 1 ? area * y + side * x + z : area * z + side * x + y] =
                                from[area * x + side * y + z];
            }
        }
    }
    /// The means over 2 width + 1 places, summed in the order of the places.
    /// @param out  of the leaf, as its own values are laid out
    void add(int width, float share, int axis, float* out) const {
        for (int place = 0; place < side; ++place) {
            std::array<float, area> sum{};
            for (int n = -width; n <= width; ++n) {
                const auto* const from = all_.data() + (side + place + n) * area;
                for (std::size_t line = 0; line < area; ++line) sum[line] += from[line];
            }
            for (int line = 0; line < area; ++line) {
                const int a = line / side, b = line % side;
                const int to = axis == 0   ? area * place + line
                               : axis == 1 ? area * a + side * place + b
                                           : area * a + side * b + place;
                out[to] = sum[static_cast<std::size_t>(line)] * share;
            }
        }
    }

private:
    std::array<float, 3 * Leaf::SIZE> all_;
};

/// Averages along an axis.
void mean_along(Leaves& leaves, int width, int axis) {
    const auto& tree = leaves.tree();
    const float share = 1.0f / static_cast<float>(2 * width + 1);
    tbb::parallel_for(leaves.leafRange(), [&](const Leaves::LeafRange& range) {
        const openvdb::tree::ValueAccessor<const Tree> accessor(tree);
        Lines lines;
        std::array<float, Leaf::SIZE> means;
        for (auto leaf = range.begin(); leaf; ++leaf) {
            lines.read(accessor, leaf->origin(), axis);
            lines.add(width, share, axis, means.data());
            auto* const out = leaf.buffer(1).data();
            for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
                out[voxel.pos()] = means[voxel.pos()];
        }
    });
    leaves.swapLeafBuffer(1);
}

}  // namespace

void box_mean(Tree& tree, int width, int iterations, const std::array<int, 3>& order) {
    // Each pass reads the values of the pass before; inactive ones are the same in both.
    Leaves leaves(tree, 1);
    for (int n = 0; n < iterations; ++n)
        for (const int axis : order) mean_along(leaves, width, axis);
}

}  // namespace fluidcarve
