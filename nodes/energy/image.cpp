#include "nodes/energy/image.h"

#include "nodes/field/extent.h"
#include "nodes/field/same_transform.h"
#include "nodes/field/stencil.h"
#include "nodes/image/image.h"
#include "nodes/io/file_sequence.h"

#include <fmt/format.h>

#include <cmath>

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
        throw Failure(fmt::format("grid '{}' is of type {}, but a channel of an image is a float grid; name the `channels` to take", name, grid->type()));
    return openvdb::gridConstPtrCast<FloatGrid>(grid);
}

std::vector<Term> terms_of(const Volume& image, const std::optional<std::vector<std::string>>& channels) {
    if (!channels && image.find("R") && image.find("G") && image.find("B"))
        return {{channel_of(image, "R"), 0.2126f}, {channel_of(image, "G"), 0.7152f}, {channel_of(image, "B"), 0.0722f}};
    std::vector<Term> out;
    if (channels) {
        for (const auto& name : *channels) out.push_back({channel_of(image, name), 1});
    } else {
        for (const auto& grid : image.grids)
            if (!is_opacity(grid->getName())) out.push_back({channel_of(image, grid->getName()), 1});
    }
    if (out.empty()) throw Failure(fmt::format("there is no channel to compute the energy from; there are {}: name some in `channels`", image.names()));
    for (auto& term : out) term.weight = 1 / static_cast<float>(out.size());
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
            "source", survey, [](std::size_t) { return true; }, [&](const auto& there) { require_channels(params.channels, there); });
    }

    static void run(const Params& params, Ports& io, Context& context) {
        for (const auto& [channel, weight] : terms_of(*io.source, params.channels)) {
            require_near(channel->getName(), active_box(*channel));
            require_dense_fits(*channel, sizeof(float), context.memory_budget());
        }
        const auto values = intensity(*io.source, params.channels);
        io.energy = image_energy(*values);
        if (context.wants("intensity")) io.intensity = values;
    }
};

}  // namespace

FloatGrid::Ptr intensity(const Volume& image, const std::optional<std::vector<std::string>>& channels) {
    const auto terms = terms_of(image, channels);
    const auto& first = *terms.front().channel;
    const auto tree = std::make_shared<openvdb::FloatTree>(first.tree(), 0.0f, openvdb::TopologyCopy());
    std::string names;
    for (const auto& [channel, weight] : terms) {
        require_same_transform("channels", first, *channel);
        if (channel != terms.front().channel) tree->topologyUnion(channel->tree());
        names += (names.empty() ? "" : ", ") + channel->getName();
    }
    tree->voxelizeActiveTiles();
    openvdb::tree::LeafManager<openvdb::FloatTree>(*tree).foreach ([&](Leaf& leaf, std::size_t) {
        for (const auto& [channel, weight] : terms) {
            const auto* const from = channel->tree().probeConstLeaf(leaf.origin());
            const float tile = from ? 0 : channel->tree().getValue(leaf.origin());
            for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) voxel.setValue(*voxel + weight * (from ? from->getValue(voxel.pos()) : tile));
        }
    });
    const auto out = FloatGrid::create(tree);
    out->setTransform(first.transform().copy());
    out->setName("intensity of " + names);
    return out;
}

FloatGrid::Ptr image_energy(const FloatGrid& intensity) {
    const auto per_world = static_cast<float>(1 / cubic_voxel_size(intensity));
    const auto out = map_stencil<FloatGrid>(intensity, 0.0f, [per_world](auto& s, const openvdb::Coord& at) {
        const float here = s.getValue(at);
        const auto slope = [&](const openvdb::Coord& behind, const openvdb::Coord& ahead) {
            float from = 0, to = 0;
            const bool low = s.probeValue(behind, from), high = s.probeValue(ahead, to);
            const float rise = (high ? to : here) - (low ? from : here);
            return std::abs(rise) * (low && high ? 0.5f : 1.0f);
        };
        return per_world * (slope(at.offsetBy(-1, 0, 0), at.offsetBy(1, 0, 0)) + slope(at.offsetBy(0, -1, 0), at.offsetBy(0, 1, 0)));
    });
    out->setName("gradient of " + intensity.getName());
    return out;
}

NodeType energy_image() {
    return Declare<ImageEnergy>("energy.image",
                                "The paper's energy for images (equation 6): high where the intensity changes, so that seams avoid edges and textures.")
        .input("source", &ImageEnergy::Ports::source, "The picture: a volume with a float grid per channel, or one grid.")
        .param("channels", &ImageEnergy::Params::channels,
               "The intensity is the mean of these grids. Auto: 0.2126 R + 0.7152 G + 0.0722 B; without these channels, the mean of all channels except "
               "opacity (A, alpha).")
        .output("energy", &ImageEnergy::Ports::energy, "|dI/dx| + |dI/dy|, units of the channels per pixel, on the active voxels of `source`.")
        .output("intensity", &ImageEnergy::Ports::intensity, "The intensity, units of the channels: use it as a solver's `field`.")
        .version(2)
        .kept()
        .in_place();
}

}  // namespace fluidcarve
