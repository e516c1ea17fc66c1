#include "nodes/image.h"

#include "carve/base/words.h"
#include "formats/file/module.h"
#include "formats/file/output_file.h"
#include "formats/image/image_provenance.h"
#include "formats/image/image_volume.h"
#include "nodes/params/file_sequence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace fluidcarve {

namespace {

const ImageModule& images() { return load_module<ImageModule>("images"); }

struct ImageRead {
    struct Params {
        InputPath path;
        std::map<std::string, std::string> channels;
        Missing missing = Missing::error;
    };
    struct Ports {
        Ref<Volume> volume;
        NamedOutputs channels;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.channels.contains("volume"))
            check.fault("channels",
                        "image.read already has an output 'volume'; give this one another name");
        check_missing(params.path, params.missing, check);
    }

    /// Finds files that can't be read or lack a channel before the run starts.
    static void survey(const Params& params, Survey& survey) {
        survey_files(params.path, params.missing, survey, [&](int frame, int file) {
            const auto path = params.path.at(file);
            const auto header = images().header(path, format_of_file(path).name);
            const auto size = upright_size(header);
            for (const auto& [output, channel] : params.channels) {
                if (!survey.wants(output)) continue;
                require_channel(path, header, channel);
                survey.delivers(frame, output, {{{channel}}, size});
            }
            for (const auto& pick : survey.picks()) require_channel(path, header, pick.part);
            survey.delivers(frame, "volume", {names_of(header), size});
        });
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto path = file_of(params.path, params.missing, context);
        const auto& format = format_of_file(path);
        const auto header = images().header(path, format.name);
        for (const auto& [output, channel] : params.channels)
            require_channel(path, header, channel);
        if (const auto bytes = bytes_as_volume(header); bytes > context.limits().memory)
            throw Failure(fmt::format("{} has {} pixels of {} channels, which take {:.1f} GiB of "
                                      "memory; --memory allows {:.1f}",
                                      path, fmt::join(upright_size(header), " x "),
                                      header.channels.size(), static_cast<double>(bytes) / 0x1p30,
                                      static_cast<double>(context.limits().memory) / 0x1p30),
                          Failure::Kind::input);
        if (header.more > 0)
            context.warn(
                fmt::format("{} holds {} images; only the first is read", path, header.more + 1));
        if (header.smaller)
            context.warn(fmt::format(
                "{} holds smaller copies of its picture (mipmaps); only the largest is read",
                path));
        for (const auto& [name, depth] : header.channels)
            if (!depth_holds("float", depth) && depth != "uint" && depth != "int")
                context.warn(
                    fmt::format("{}: channel '{}' is {}; it is read as float, which keeps 24 bits",
                                path, name, depth));
        const auto volume = std::make_shared<Volume>(volume_of(images().read(path, format.name)));
        for (const auto& [output, channel] : params.channels)
            if (context.wants(output))
                io.channels[output] =
                    Payload(openvdb::gridConstPtrCast<FloatGrid>(volume->find(channel)));
        io.volume = volume;
    }

private:
    static std::vector<std::string> names_of(const Image& header) {
        std::vector<std::string> out;
        for (const auto& each : header.channels) out.push_back(each.name);
        return out;
    }

    static void require_channel(const std::string& path, const Image& header,
                                const std::string& channel) {
        const auto names = names_of(header);
        if (std::ranges::find(names, channel) != names.end()) return;
        const auto best = nearest(channel, names);
        throw Failure(fmt::format("{} has no channel '{}'; it has {}{}", path, channel,
                                  fmt::join(names, ", "),
                                  best.empty() ? "" : fmt::format("; did you mean '{}'?", best)),
                      Failure::Kind::input);
    }
};

}  // namespace

NodeType image_read() {
    using Params = ImageRead::Params;
    return Declare<ImageRead>(
               "image.read",
               "Reads images, or videos as sequences of images (PNG, EXR, JPEG, TIFF): one float "
               "grid per channel, one voxel of size 1 per pixel, the lower left pixel at [0, 0, "
               "0]. Pictures are turned upright by the file's orientation. Values are not "
               "converted, except that integers are divided by the largest value of their depth.")
        .required("path", &Params::path, "File, or sequence with a frame token such as ####.")
        .param("channels", &Params::channels,
               "Channels to offer as outputs, for masks and terms of an energy: `{matte: A}` makes "
               "`photo.matte` from channel A. Channels are called R, G, B, A, Y (grey), or as in "
               "the file.")
        .param("missing", &Params::missing, missing_doc)
        .output("volume", &ImageRead::Ports::volume,
                "All channels, in the order of the file, with the file's attributes.")
        .outputs_from("channels", &ImageRead::Ports::channels, [](const Params& params) {
            std::vector<std::pair<std::string, std::type_index>> out;
            for (const auto& [name, channel] : params.channels)
                out.emplace_back(name, typeid(FloatGrid));
            return out;
        });
}

namespace {

enum class Depth { uint8, uint16, half, floating };

}  // namespace

template <>
struct ChoiceNames<Depth> {
    static constexpr std::array names = {
        std::pair{"uint8", Depth::uint8}, std::pair{"uint16", Depth::uint16},
        std::pair{"half", Depth::half}, std::pair{"float", Depth::floating}};
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
        if (!format)
            return check.fault("path",
                               fmt::format("'path' must end in one of {}", image_endings()));
        if (params.depth &&
            std::ranges::find(format->depths, ParamTraits<Depth>::text(*params.depth)) ==
                format->depths.end())
            check.fault("depth", fmt::format("{} holds {}, not {}", format->shown,
                                             fmt::join(format->depths, " or "),
                                             ParamTraits<Depth>::text(*params.depth)));
        if (check.stated("quality") && format->name != "jpeg")
            check.fault("quality",
                        fmt::format("'quality' is for JPEG; {} is lossless", format->shown));
    }

    static void survey(const Params& params, Survey& survey) {
        survey_channels(params.channels, survey);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto path = params.path.at(context.frame());
        ImageRequest request{format_of_name(path), {}, params.channels};
        if (params.depth) request.depth = ParamTraits<Depth>::text(*params.depth);
        const auto warn = [&](const std::string& message) { context.warn(message); };
        const auto& module = load_module<ImageModule>("images");
        try {
            auto image = image_of(*io.source, request, warn);
            if (image.format == "jpeg")
                warn(
                    "JPEG keeps 8 bits and changes values a little each time it is written; PNG, "
                    "TIFF and EXR keep them");
            const auto provenance = context.provenance();
            // PNG and JPEG get the provenance below: OpenImageIO does not write it to JPEG.
            if (image.format == "openexr")
                for (const auto& [name, text] : provenance)
                    image.attributes.push_back({name, "string", text});
            OutputFile output(path);
            module.write(output.aside(), image, params.quality);
            verify(module, output, image, *request.format, warn);
            add_provenance(output.aside(), provenance);
            output.commit();
        } catch (const Failure& failure) {
            const std::string reason = failure.what();
            throw Failure(reason.starts_with("cannot write")
                              ? reason
                              : fmt::format("cannot write {}: {}", path, reason),
                          failure.kind);
        }
    }

private:
    /// Reads the file back, to find write errors such as a full disk, and attributes that the
    /// format does not hold.
    static void verify(const ImageModule& module, const OutputFile& output, const Image& written,
                       const ImageFormat& format,
                       const std::function<void(const std::string&)>& warn) {
        Image read;
        try {
            read = module.checked(output.aside(), written.format);
        } catch (const Failure&) {}
        if (read.data.width != written.data.width || read.data.height != written.data.height ||
            read.channels.size() != written.channels.size())
            throw output.not_whole();
        std::vector<std::string> lost;
        for (const auto& attribute : written.attributes)
            if (!attribute.name.starts_with("oiio:") && !holds(read, attribute.name))
                lost.push_back(attribute.name);
        constexpr std::size_t most = 8;
        const auto more =
            lost.size() > most ? fmt::format(" and {} more", lost.size() - most) : std::string();
        lost.resize(std::min(lost.size(), most));
        if (!lost.empty())
            warn(fmt::format("{} can't hold some attributes of the image, which are left out: {}{}",
                             format.shown, fmt::join(lost, ", "), more));
    }

    static bool holds(const Image& image, const std::string& name) {
        return std::ranges::any_of(image.attributes, [&](const auto& each) {
            return std::ranges::equal(each.name, name, [](unsigned char a, unsigned char b) {
                return std::tolower(a) == std::tolower(b);
            });
        });
    }
};

}  // namespace

NodeType image_write() {
    using Params = ImageWrite::Params;
    return Declare<ImageWrite>(
               "image.write",
               "Writes images: the box of a volume's active voxels, one pixel per voxel, so that a "
               "carved image comes out narrower. Depth, channel names and attributes of the image "
               "that was read are kept as far as the format holds them. Values are not converted, "
               "except for opacity: colours are multiplied by it in EXR, and not in PNG. A file "
               "appears whole or not at all.")
        .input("source", &ImageWrite::Ports::source,
               "A volume whose float grids are the channels, in one plane of voxels; or one grid.")
        .required("path", &Params::path,
                  "File that ends in .png, .exr, .jpg, .jpeg, .tif or .tiff; with a frame token "
                  "such as #### if the source comes per frame.")
        .param("channels", &Params::channels, "Grids to write, in this order. Auto is all of them.")
        .param("depth", &Params::depth,
               "Depth of all channels. Auto: as each was read, or, if the format does not hold "
               "that, the smallest depth that loses nothing (8 bits become half floats in EXR); "
               "for grids made by nodes, the largest depth of the format. PNG holds uint8 and "
               "uint16, JPEG uint8, TIFF all but half, EXR half and float. Values outside the "
               "range of a depth are clamped, with a warning that counts them.")
        .param("quality", &Params::quality, Unit::none, between(1, 100),
               "JPEG quality. Even 100 is not lossless.");
}

}  // namespace fluidcarve
