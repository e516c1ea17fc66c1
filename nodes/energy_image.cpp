#include "nodes/energy_image.h"

#include "carve/energy/image.h"
#include "carve/field/dense.h"
#include "carve/field/extent.h"
#include "formats/image/image.h"
#include "nodes/params/file_sequence.h"

#include <fmt/format.h>

namespace fluidcarve {

namespace {

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

std::vector<WeightedChannel> terms_of(const Volume& image,
                                      const std::optional<std::vector<std::string>>& channels) {
    if (!channels) {
        if (const auto colours = colours_of(image.given_names()); !colours.empty())
            return {{channel_of(image, colours[0]), 0.2126f},
                    {channel_of(image, colours[1]), 0.7152f},
                    {channel_of(image, colours[2]), 0.0722f}};
    }
    std::vector<WeightedChannel> out;
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

struct ImageEnergy {
    struct Params {
        Auto<std::vector<std::string>> channels;
    };
    struct Ports {
        Ref<Volume> source;
        Ref<FloatGrid> energy, intensity;
    };

    static void survey(const Params& params, Survey& survey) {
        survey_channels(params.channels, survey);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        for (const auto& [channel, weight] : terms_of(*io.source, params.channels)) {
            require_near(channel->getName(), active_box(*channel));
            require_dense_fits(*channel, sizeof(float), context.limits().memory);
        }
        io.energy = image_energy(*io.source, params.channels);
        if (context.wants("intensity")) io.intensity = intensity(*io.source, params.channels);
    }
};

}  // namespace

FloatGrid::Ptr intensity(const Volume& image,
                         const std::optional<std::vector<std::string>>& channels) {
    return image_intensity(terms_of(image, channels));
}

FloatGrid::Ptr image_energy(const Volume& image,
                            const std::optional<std::vector<std::string>>& channels) {
    return image_energy(terms_of(image, channels));
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
