#include "nodes/image/read.h"

#include "graph/types/module.h"
#include "nodes/image/image_volume.h"
#include "nodes/io/file_sequence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

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
        if (params.channels.contains("volume")) check.fault("channels", "image.read already has an output 'volume'; give this one another name");
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
        for (const auto& [output, channel] : params.channels) require_channel(path, header, channel);
        if (const auto bytes = bytes_as_volume(header); bytes > context.memory_budget())
            throw Failure(fmt::format("{} has {} x {} pixels of {} channels, which take {:.1f} GiB of memory; --memory allows {:.1f}", path, header.data.width,
                                      header.data.height, header.channels.size(), static_cast<double>(bytes) / 0x1p30,
                                      static_cast<double>(context.memory_budget()) / 0x1p30),
                          Failure::Kind::input);
        if (header.more > 0) context.warn(fmt::format("{} holds {} images; only the first is read", path, header.more + 1));
        if (header.smaller) context.warn(fmt::format("{} holds smaller copies of its picture (mipmaps); only the largest is read", path));
        for (const auto& [name, depth] : header.channels)
            if (!depth_holds("float", depth) && depth != "uint" && depth != "int")
                context.warn(fmt::format("{}: channel '{}' is {}; it is read as float, which keeps 24 bits", path, name, depth));
        const auto volume = std::make_shared<Volume>(volume_of(images().read(path, format.name)));
        for (const auto& [output, channel] : params.channels)
            if (context.wants(output)) io.channels[output] = Payload(openvdb::gridConstPtrCast<FloatGrid>(volume->find(channel)));
        io.volume = volume;
    }

private:
    static std::vector<std::string> names_of(const Image& header) {
        std::vector<std::string> out;
        for (const auto& each : header.channels) out.push_back(each.name);
        return out;
    }

    static void require_channel(const std::string& path, const Image& header, const std::string& channel) {
        const auto names = names_of(header);
        if (std::find(names.begin(), names.end(), channel) != names.end()) return;
        const auto best = nearest(channel, names);
        throw Failure(fmt::format("{} has no channel '{}'; it has {}{}", path, channel, fmt::join(names, ", "),
                                  best.empty() ? "" : fmt::format("; did you mean '{}'?", best)),
                      Failure::Kind::input);
    }
};

}  // namespace

NodeType image_read() {
    using Params = ImageRead::Params;
    return Declare<ImageRead>("image.read",
                              "Reads images, or videos as sequences of images (PNG, EXR, JPEG, TIFF): one float grid per channel, one voxel of size 1 per "
                              "pixel, the lower left pixel at [0, 0, 0]. Pictures are turned upright by the file's orientation. Values are not converted, "
                              "except that integers are divided by the largest value of their depth.")
        .required("path", &Params::path, "File, or sequence with a frame token such as ####.")
        .param(
            "channels", &Params::channels,
            "Channels to offer as outputs, for masks and terms of an energy: `{matte: A}` makes `photo.matte` from channel A. Channels are called R, G, B, A, "
            "Y (grey), or as in the file.")
        .param("missing", &Params::missing, missing_doc)
        .output("volume", &ImageRead::Ports::volume, "All channels, in the order of the file, with the file's attributes.")
        .outputs_from("channels", &ImageRead::Ports::channels, [](const Params& params) {
            std::vector<std::pair<std::string, std::type_index>> out;
            for (const auto& [name, channel] : params.channels) out.emplace_back(name, typeid(FloatGrid));
            return out;
        });
}

}  // namespace fluidcarve
