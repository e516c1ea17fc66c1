#include "carve/energy/image.h"

#include "carve/field/same_transform.h"
#include "carve/field/stencil.h"
#include "carve/field/voxel_axes.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>

namespace fluidcarve {

namespace {

using Leaf = FloatGrid::TreeType::LeafNodeType;

/// A grid for the intensity, still 0: active where any channel is, without active tiles.
/// @throws Failure if the channels' transforms differ
FloatGrid::Ptr blank(const std::vector<WeightedChannel>& channels) {
    const auto& first = *channels.front().channel;
    const auto tree =
        std::make_shared<openvdb::FloatTree>(first.tree(), 0.0f, openvdb::TopologyCopy());
    std::string names;
    for (const auto& [channel, weight] : channels) {
        require_same_transform("channels", first, *channel);
        if (channel != channels.front().channel) tree->topologyUnion(channel->tree());
        names += (names.empty() ? "" : ", ") + channel->getName();
    }
    tree->voxelizeActiveTiles();
    const auto out = FloatGrid::create(tree);
    out->setTransform(first.transform().copy());
    out->setName("intensity of " + names);
    return out;
}

/// The intensity in a leaf, and in the voxels beside it along x and y.
class LeafIntensity {
public:
    struct Row {
        std::array<float, 8> values;  ///< `[z]`
        unsigned on;                  ///< a bit for each; values of others are undefined
    };

    /// @param active  where the intensity is, without active tiles
    LeafIntensity(const std::vector<WeightedChannel>& channels, const openvdb::FloatTree& active)
        : active_(active) {
        for (const auto& [channel, weight] : channels)
            channels_.push_back({channel->getConstAccessor(), weight, nullptr, 0});
    }

    void move_to(const openvdb::Coord& origin) {
        read(origin, 0, 0);
        for (const int side : {-1, 1}) {
            read(origin, side, 0);
            read(origin, 0, side);
        }
    }
    /// @param x, y  -1 to 8; not both outside of the leaf
    const Row& row(int x, int y) const { return rows_[place(x, y)]; }

private:
    struct Channel {
        FloatGrid::ConstAccessor all;
        float weight;
        const float* values;  ///< of the leaf that is read; null: it is a tile
        float tile;
    };
    static std::size_t place(int x, int y) {
        return 10 * static_cast<std::size_t>(x + 1) + static_cast<std::size_t>(y + 1);
    }

    /// Reads the leaf, or what is needed of one beside it.
    /// @param a, b  along x and y: -1 before it, 1 behind it
    void read(const openvdb::Coord& origin, int a, int b) {
        const auto at = origin.offsetBy(8 * a, 8 * b, 0);
        const auto* const active = active_.probeConstLeaf(at);
        for (auto& channel : channels_) {
            const auto* const leaf = active ? channel.all.probeConstLeaf(at) : nullptr;
            channel.values = leaf ? leaf->buffer().data() : nullptr;
            channel.tile = active && !leaf ? channel.all.getValue(at) : 0;
        }
        for (int x = a < 0 ? 7 : 0; x <= (a > 0 ? 0 : 7); ++x)
            for (int y = b < 0 ? 7 : 0; y <= (b > 0 ? 0 : 7); ++y) {
                auto& row = rows_[place(x + 8 * a, y + 8 * b)];
                row.on = active ? active->getValueMask().getWord<unsigned char>(
                                      static_cast<openvdb::Index>(8 * x + y))
                                : 0u;
                for (auto left = row.on; left != 0; left &= left - 1) {
                    const auto z = static_cast<std::size_t>(std::countr_zero(left));
                    float sum = 0;
                    for (const auto& each : channels_)
                        sum +=
                            each.weight *
                            (each.values ? each.values[static_cast<std::size_t>(64 * x + 8 * y) + z]
                                         : each.tile);
                    row.values[z] = sum;
                }
            }
    }

    std::vector<Channel> channels_;
    openvdb::tree::ValueAccessor<const openvdb::FloatTree> active_;
    std::array<Row, 100> rows_;
};

}  // namespace

FloatGrid::Ptr image_intensity(const std::vector<WeightedChannel>& channels) {
    auto out = blank(channels);
    openvdb::tree::LeafManager<openvdb::FloatTree>(out->tree())
        .foreach ([&](Leaf& leaf, std::size_t) {
            for (const auto& [channel, weight] : channels) {
                const auto* const from = channel->tree().probeConstLeaf(leaf.origin());
                const float tile = from ? 0 : channel->tree().getValue(leaf.origin());
                for (auto voxel = leaf.beginValueOn(); voxel; ++voxel)
                    voxel.setValue(*voxel + weight * (from ? from->getValue(voxel.pos()) : tile));
            }
        });
    return out;
}

FloatGrid::Ptr image_energy(const std::vector<WeightedChannel>& channels) {
    const auto out = blank(channels);
    const VoxelAxes axes(out->transform());
    const auto per_x = static_cast<float>(1 / axes.step(0).length()),
               per_y = static_cast<float>(1 / axes.step(1).length());
    std::mutex mutex;
    std::optional<openvdb::Coord> lowest;  ///< where something is not finite
    const openvdb::tree::LeafManager<openvdb::FloatTree> leaves(out->tree());
    tbb::parallel_for(leaves.leafRange(), [&](const auto& range) {
        LeafIntensity around(channels, out->tree());
        for (auto leaf = range.begin(); leaf; ++leaf) {
            around.move_to(leaf->origin());
            for (auto voxel = leaf->beginValueOn(); voxel; ++voxel) {
                const auto at = Leaf::offsetToLocalCoord(voxel.pos());
                const auto z = static_cast<std::size_t>(at.z());
                const float here = around.row(at.x(), at.y()).values[z];
                const auto slope = [&](const LeafIntensity::Row& behind,
                                       const LeafIntensity::Row& ahead) {
                    const bool low = (behind.on >> z & 1) != 0, high = (ahead.on >> z & 1) != 0;
                    const float rise =
                        (high ? ahead.values[z] : here) - (low ? behind.values[z] : here);
                    return std::abs(rise) * (low && high ? 0.5f : 1.0f);
                };
                const float energy =
                    per_x * slope(around.row(at.x() - 1, at.y()), around.row(at.x() + 1, at.y())) +
                    per_y * slope(around.row(at.x(), at.y() - 1), around.row(at.x(), at.y() + 1));
                voxel.setValue(energy);
                if (std::isfinite(energy) && std::isfinite(here)) continue;
                const std::lock_guard lock(mutex);
                if (!lowest || voxel.getCoord() < *lowest) lowest = voxel.getCoord();
            }
        }
    });
    if (lowest) refuse_not_finite(*image_intensity(channels), *lowest);
    out->setName("gradient of " + out->getName());
    return out;
}

}  // namespace fluidcarve
