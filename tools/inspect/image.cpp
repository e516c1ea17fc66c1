#include "tools/inspect/image.h"

#include "carve/base/one_line.h"
#include "formats/file/module.h"
#include "formats/image/image.h"
#include "tools/inspect/facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

/// First and last pixel, y down as in files.
Json window_json(const Image::Window& window) {
    return {{window.x, window.y}, {window.x + window.width - 1, window.y + window.height - 1}};
}

/// The least and the greatest value of a channel of whole numbers of 32 bits, whose pixels are
/// their bits.
template <class Number>
Json range_of_bits(const Image& image, std::size_t channel) {
    Number low = std::numeric_limits<Number>::max(), high = std::numeric_limits<Number>::min();
    for (auto n = channel; n < image.pixels.size(); n += image.channels.size()) {
        const auto value = std::bit_cast<Number>(image.pixels[n]);
        low = std::min(low, value), high = std::max(high, value);
    }
    return {low, high};
}

Json channel_json(const Image& image, std::size_t channel, std::vector<std::string>& oddities) {
    Json out{{"name", one_line(image.channels[channel].name)},
             {"depth", image.channels[channel].depth}};
    const auto& depth = image.channels[channel].depth;
    if (depth == "uint" || depth == "int") {
        out["range"] = depth == "uint" ? range_of_bits<std::uint32_t>(image, channel)
                                       : range_of_bits<std::int32_t>(image, channel);
        return out;
    }
    float low = std::numeric_limits<float>::infinity(), high = -low;
    std::size_t not_finite = 0;
    for (auto n = channel; n < image.pixels.size(); n += image.channels.size()) {
        const float value = image.pixels[n];
        if (!std::isfinite(value)) ++not_finite;
        else low = std::min(low, value), high = std::max(high, value);
    }
    if (low <= high) out["range"] = {low, high};
    if (not_finite > 0) {
        out["not_finite"] = not_finite;
        oddities.push_back(fmt::format("{}: {} values are not finite: energies refuse them",
                                       out["name"].get<std::string>(), not_finite));
    }
    return out;
}

Json look_at_image(const std::string& path) {
    const auto& format = format_of_file(path);
    const auto image = load_module<ImageModule>("images").read(path, format.name);
    std::vector<std::string> oddities;
    Json out{{"file", path},
             {"kind", "image"},
             {"bytes", std::filesystem::file_size(path)},
             {"format", format.shown},
             {"width", image.data.width},
             {"height", image.data.height},
             {"data_window", window_json(image.data)},
             {"display_window", window_json(image.display)}};
    out["channels"] = Json::array();
    for (std::size_t channel = 0; channel < image.channels.size(); ++channel)
        out["channels"].push_back(channel_json(image, channel, oddities));
    if (image.data != image.display)
        oddities.push_back(
            "the stored pixels are not those of the display window: see `data_window` and "
            "`display_window` of --json");
    if (image.more > 0)
        oddities.push_back(
            fmt::format("it holds {} images; only the first is read", image.more + 1));
    out["oddities"] = oddities;
    return out;
}

std::string size_of_image(const Json& file) {
    return fmt::format("{} x {} pixels", count_text(file["width"]), count_text(file["height"]));
}

/// Finds the first image of another size than the first one.
std::vector<std::string> compare_images(const std::vector<Json>& files) {
    for (const auto& file : files)
        if (size_of_image(file) != size_of_image(files.front()))
            return {fmt::format(
                "{} in {}, but {} in {}: if these are frames of one sequence, no lattice fits",
                size_of_image(files.front()), files.front()["file"].get<std::string>(),
                size_of_image(file), file["file"].get<std::string>())};
    return {};
}

std::string image_text(const Json& file) {
    auto out = fmt::format("{}: {} bytes, {}, {}\n", file["file"].get<std::string>(),
                           count_text(file["bytes"]), file["format"].get<std::string>(),
                           size_of_image(file));
    std::size_t widest = 4;
    for (const auto& channel : file["channels"])
        widest = std::max(widest, channel["name"].get<std::string>().size());
    for (const auto& channel : file["channels"]) {
        out += fmt::format("  {:<{}}  {}", channel["name"].get<std::string>(), widest,
                           channel["depth"].get<std::string>());
        if (channel.contains("range")) out += ", " + range_text(channel["range"]);
        out += "\n";
    }
    for (const auto& oddity : file["oddities"])
        out += "  note: " + oddity.get<std::string>() + "\n";
    return out;
}

}  // namespace

FileInspector image_inspector() {
    return {all_image_endings(), {}, "channels", &look_at_image, &compare_images, &image_text};
}

}  // namespace fluidcarve
