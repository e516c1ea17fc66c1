#include "nodes/energy_image.h"

#include "carve/field/extent.h"
#include "carve/field/same_transform.h"
#include "carve/field/stencil.h"
#include "carve/field/voxel_axes.h"
#include "formats/image/image.h"
#include "nodes/params/file_sequence.h"

#include <fmt/format.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <mutex>

namespace fluidcarve {

namespace {

using Leaf = FloatGrid::TreeType::LeafNodeType;

/// A channel and its weight in the intensity.
struct Term {
    FloatGrid::ConstPtr channel;
    float weight;
};

FloatGrid::ConstPtr channel_of(const Volume& image, const std::string& name) {
    const auto grid = image.find(name);
    if (!grid) throw Failure(no_channel(name, image.names()));
    if (!grid->isType<FloatGrid>())
        throw Failure(
            fmt::format("grid '{}' is of type {}, but a channel of an image is a float grid; name "
                        "the `channels` to take",
                        name, grid->type()));
    return openvdb::gridConstPtrCast<FloatGrid>(grid);
}

std::vector<Term> terms_of(const Volume& image,
                           const std::optional<std::vector<std::string>>& channels) {
    if (!channels) {
        if (const auto colours = colours_of(image.given_names()); !colours.empty())
            return {{channel_of(image, colours[0]), 0.2126f},
                    {channel_of(image, colours[1]), 0.7152f},
                    {channel_of(image, colours[2]), 0.0722f}};
    }
    std::vector<Term> out;
    if (channels) {
        for (const auto& name : *channels) out.push_back({channel_of(image, name), 1});
    } else {
        for (const auto& grid : image.grids)
            if (const auto name = grid.name();
                !grid.header().isType<openvdb::Int32Grid>() && !is_opacity(name) && !is_depth(name))
                out.push_back({channel_of(image, name), 1});
    }
    if (out.empty())
        throw Failure(fmt::format(
            "there is no channel to compute the energy from; there are {}: name some in `channels`",
            image.names()));
    for (auto& term : out) term.weight = 1 / static_cast<float>(out.size());
    return out;
}

/// A grid for the intensity, still 0: active where any channel is, without active tiles.
/// @throws Failure if the channels' transforms differ
FloatGrid::Ptr blank(const std::vector<Term>& terms) {
    const auto& first = *terms.front().channel;
    const auto tree =
        std::make_shared<openvdb::FloatTree>(first.tree(), 0.0f, openvdb::TopologyCopy());
    std::string names;
    for (const auto& [channel, weight] : terms) {
        require_same_transform("channels", first, *channel);
        if (channel != terms.front().channel) tree->topologyUnion(channel->tree());
        names += (names.empty() ? "" : ", ") + channel->getName();
    }
    tree->voxelizeActiveTiles();
    const auto out = FloatGrid::create(tree);
    out->setTransform(first.transform().copy());
    out->setName("intensity of " + names);
    return out;
}

FloatGrid::Ptr intensity_of(const std::vector<Term>& terms) {
    auto out = blank(terms);
    openvdb::tree::LeafManager<openvdb::FloatTree>(out->tree())
        .foreach ([&](Leaf& leaf, std::size_t) {
            for (const auto& [channel, weight] : terms) {
                const auto* const from = channel->tree().probeConstLeaf(leaf.origin());
                const float tile = from ? 0 : channel->tree().getValue(leaf.origin());
                for (auto voxel = leaf.beginValueOn(); voxel; ++voxel)
                    voxel.setValue(*voxel + weight * (from ? from->getValue(voxel.pos()) : tile));
            }
        });
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
    LeafIntensity(const std::vector<Term>& terms, const openvdb::FloatTree& active)
        : active_(active) {
        for (const auto& [channel, weight] : terms)
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

/// image_energy() of the intensity that the terms make, which is never stored as a whole.
FloatGrid::Ptr energy_of(const std::vector<Term>& terms) {
    const auto out = blank(terms);
    const VoxelAxes axes(out->transform());
    const auto per_x = static_cast<float>(1 / axes.step(0).length()),
               per_y = static_cast<float>(1 / axes.step(1).length());
    std::mutex mutex;
    std::optional<openvdb::Coord> lowest;  ///< where something is not finite
    const openvdb::tree::LeafManager<openvdb::FloatTree> leaves(out->tree());
    tbb::parallel_for(leaves.leafRange(), [&](const auto& range) {
        LeafIntensity around(terms, out->tree());
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
    if (lowest) refuse_not_finite(*intensity_of(terms), *lowest);
    out->setName("gradient of " + out->getName());
    return out;
}

struct ImageEnergy {
    struct Params {
        Auto<std::vector<std::string>> channels;
    };
    struct Ports {
        Ref<Volume> source;
        Ref<FloatGrid> energy, intensity;
    };

    static void survey(const Params& params, Survey& survey) {
        survey_grids(
            "source", survey, [](std::size_t) { return true; },
            [&](const auto& there) { require_channels(params.channels, there); });
    }

    static void run(const Params& params, Ports& io, Context& context) {
        for (const auto& [channel, weight] : terms_of(*io.source, params.channels)) {
            require_near(channel->getName(), active_box(*channel));
            require_dense_fits(*channel, sizeof(float), context.memory_budget());
        }
        io.energy = image_energy(*io.source, params.channels);
        if (context.wants("intensity")) io.intensity = intensity(*io.source, params.channels);
    }
};

}  // namespace

FloatGrid::Ptr intensity(const Volume& image,
                         const std::optional<std::vector<std::string>>& channels) {
    return intensity_of(terms_of(image, channels));
}

FloatGrid::Ptr image_energy(const Volume& image,
                            const std::optional<std::vector<std::string>>& channels) {
    return energy_of(terms_of(image, channels));
}

NodeType energy_image() {
    return Declare<ImageEnergy>("energy.image",
                                "The paper's energy for images (equation 6): high where the "
                                "intensity changes, so that seams avoid edges and textures.")
        .input("source", &ImageEnergy::Ports::source,
               "The picture: a volume with a float grid per channel, or one grid.")
        .param("channels", &ImageEnergy::Params::channels,
               "The intensity is the mean of these grids. Auto: 0.2126 R + 0.7152 G + 0.0722 B, if "
               "need be of a layer, such as ViewLayer.Combined; without these channels, the mean "
               "of all but opacity (A, alpha), depth and identities.")
        .output(
            "energy", &ImageEnergy::Ports::energy,
            "|dI/dx| + |dI/dy|, units of the channels per pixel, on the active voxels of `source`.")
        .output("intensity", &ImageEnergy::Ports::intensity,
                "The intensity, units of the channels: use it as a solver's `field`.")
        .version(2)
        .kept()
        .in_place();
}

}  // namespace fluidcarve
