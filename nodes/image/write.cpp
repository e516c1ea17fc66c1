#include "nodes/image/write.h"

#include "graph/output_file.h"
#include "graph/types/module.h"
#include "nodes/image/image_provenance.h"
#include "nodes/image/image_volume.h"
#include "nodes/io/file_sequence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace fluidcarve {

namespace {
enum class Depth { uint8, uint16, half, floating };
}

template <>
struct ChoiceNames<Depth> {
    static constexpr std::array names = {std::pair{"uint8", Depth::uint8}, std::pair{"uint16", Depth::uint16}, std::pair{"half", Depth::half},
                                         std::pair{"float", Depth::floating}};
};

namespace {

struct ImageWrite {
    struct Params {
        OutputPath path;
        Auto<std::vector<std::string>> channels;
        Auto<Depth> depth;
        int quality = 95;
    };
    struct Ports {
        Ref<Volume> source;
    };

    static void check(const Params& params, NodeCheck& check) {
        const auto* const format = format_of_name(params.path.text());
        if (!format) return check.fault("path", fmt::format("'path' must end in one of {}", image_endings()));
        if (params.depth && std::find(format->depths.begin(), format->depths.end(), ParamTraits<Depth>::text(*params.depth)) == format->depths.end())
            check.fault("depth", fmt::format("{} holds {}, not {}", format->shown, fmt::join(format->depths, " or "), ParamTraits<Depth>::text(*params.depth)));
        if (check.stated("quality") && format->name != "jpeg") check.fault("quality", fmt::format("'quality' is for JPEG; {} is lossless", format->shown));
    }

    static void survey(const Params& params, Survey& survey) {
        survey_grids(
            "source", survey, [](std::size_t) { return true; }, [&](const auto& there) { require_channels(params.channels, there); });
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto path = params.path.at(context.frame());
        ImageWish wish{format_of_name(path), {}, params.channels};
        if (params.depth) wish.depth = ParamTraits<Depth>::text(*params.depth);
        const auto warn = [&](const std::string& message) { context.warn(message); };
        const auto& module = load_module<ImageModule>("images");
        try {
            auto image = image_of(*io.source, wish, warn);
            if (image.format == "jpeg") warn("JPEG keeps 8 bits and changes values a little each time it is written; PNG, TIFF and EXR keep them");
            const auto provenance = context.provenance();
            // PNG and JPEG get it below: OpenImageIO does not write it to JPEG.
            if (image.format == "openexr")
                for (const auto& [name, text] : provenance) image.attributes.push_back({name, "string", text});
            OutputFile output(path);
            module.write(output.aside(), image, params.quality);
            verify(module, output, image, *wish.format, warn);
            add_provenance(output.aside(), provenance);
            output.commit();
        } catch (const Failure& failure) {
            const std::string reason = failure.what();
            throw Failure(reason.starts_with("cannot write") ? reason : fmt::format("cannot write {}: {}", path, reason), failure.kind);
        }
    }

private:
    /// Reads the file back, to find write errors such as a full disk, and attributes that the format does not hold.
    static void verify(const ImageModule& module, const OutputFile& output, const Image& written, const ImageFormat& format,
                       const std::function<void(const std::string&)>& warn) {
        Image read;
        try {
            read = module.checked(output.aside(), written.format);
        } catch (const Failure&) {}
        if (read.data.width != written.data.width || read.data.height != written.data.height || read.channels.size() != written.channels.size())
            throw output.not_whole();
        std::vector<std::string> lost;
        for (const auto& attribute : written.attributes)
            if (!attribute.name.starts_with("oiio:") && !holds(read, attribute.name)) lost.push_back(attribute.name);
        constexpr std::size_t most = 8;
        const auto more = lost.size() > most ? fmt::format(" and {} more", lost.size() - most) : std::string();
        lost.resize(std::min(lost.size(), most));
        if (!lost.empty()) warn(fmt::format("{} can't hold some attributes of the image, which are left out: {}{}", format.shown, fmt::join(lost, ", "), more));
    }

    static bool holds(const Image& image, const std::string& name) {
        return std::any_of(image.attributes.begin(), image.attributes.end(), [&](const auto& each) {
            return std::equal(each.name.begin(), each.name.end(), name.begin(), name.end(),
                              [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
        });
    }
};

}  // namespace

NodeType image_write() {
    using Params = ImageWrite::Params;
    return Declare<ImageWrite>(
               "image.write",
               "Writes images: the box of a volume's active voxels, one pixel per voxel, so that a carved image comes out narrower. Depth, channel names and "
               "attributes of the image that was read are kept as far as the format holds them. Values are not converted, except for opacity: colours are "
               "multiplied by it in EXR, and not in PNG. A file appears whole or not at all.")
        .input("source", &ImageWrite::Ports::source, "A volume whose float grids are the channels, in one plane of voxels; or one grid.")
        .required("path", &Params::path,
                  "File that ends in .png, .exr, .jpg, .jpeg, .tif or .tiff; with a frame token such as #### if the source comes per frame.")
        .param("channels", &Params::channels, "Grids to write, in this order. Auto is all of them.")
        .param("depth", &Params::depth,
               "Depth of all channels. Auto: as each was read, or, if the format does not hold that, the smallest depth that loses nothing (8 bits become half "
               "floats in EXR); for grids made by nodes, the largest depth of the format. PNG holds uint8 and uint16, JPEG uint8, TIFF all but half, EXR half "
               "and float. Values outside the range of a depth are clamped, with a warning that counts them.")
        .param("quality", &Params::quality, Unit::none, between(1, 100), "JPEG quality. Even 100 is not lossless.");
}

}  // namespace fluidcarve
