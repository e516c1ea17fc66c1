#include "formats/image/image.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fluidcarve {

namespace {

[[noreturn]] void refuse(const std::string& message) {
    throw Failure(message, Failure::Kind::input);
}

const std::vector<ImageFormat>& formats() {
    using namespace std::string_literals;
    static const std::vector<ImageFormat> all{
        {"png", "PNG", {".png"}, {"\x89PNG\r\n\x1a\n"}, {"uint8", "uint16"}},
        {"openexr", "EXR", {".exr"}, {"\x76\x2f\x31\x01"}, {"half", "float"}},
        {"jpeg", "JPEG", {".jpg", ".jpeg"}, {"\xff\xd8\xff"}, {"uint8"}},
        {"tiff",
         "TIFF",
         {".tif", ".tiff"},
         {"II*\0"s, "MM\0*"s, "II+\0"s, "MM\0+"s},
         {"uint8", "int8", "uint16", "int16", "float", "double"}},
    };
    return all;
}

std::string shown_formats() {
    std::string out;
    for (const auto& format : formats()) out += (out.empty() ? "" : ", ") + format.shown;
    return out;
}

}  // namespace

const ImageFormat* format_of_name(const std::string& path) {
    const auto ending = ending_of(path);
    for (const auto& format : formats())
        if (std::ranges::find(format.endings, ending) != format.endings.end()) return &format;
    return nullptr;
}

const ImageFormat& format_of_file(const std::string& path) {
    const auto begin = InputFile(path, image_use).head(8);
    for (const auto& format : formats())
        for (const auto& start : format.starts) {
            if (!begin.starts_with(start)) continue;
            const auto* const named = format_of_name(path);
            if (named && named != &format)
                refuse(fmt::format("{} holds {}, but its name says {}; rename it to end in {}",
                                   path, format.shown, named->shown, format.endings.front()));
            return format;
        }
    refuse(begin.empty() ? fmt::format("{} is empty", path)
                         : fmt::format("{} is not an image in a supported format: {}", path,
                                       shown_formats()));
}

std::vector<std::string> all_image_endings() {
    std::vector<std::string> out;
    for (const auto& format : formats())
        out.insert(out.end(), format.endings.begin(), format.endings.end());
    return out;
}

std::string image_endings() { return fmt::format("{}", fmt::join(all_image_endings(), ", ")); }

std::string no_channel(const std::string& channel, const std::string& there) {
    return fmt::format("there is no channel '{}'; there are {}", channel, there);
}

void require_channels(const std::optional<std::vector<std::string>>& wanted,
                      const std::vector<std::string>& there) {
    if (!wanted) return;
    for (const auto& channel : *wanted)
        if (std::ranges::find(there, channel) == there.end())
            throw Failure(no_channel(channel, fmt::format("{}", fmt::join(there, ", "))));
}

bool is_opacity(const std::string& channel) {
    const auto name = channel.substr(channel.rfind('.') + 1);
    return name == "A" || name == "alpha" || name == "Alpha";
}

namespace {

/// Whether a part of a channel's name between dots is one of some words, in any case.
bool has_part(const std::string& channel, std::initializer_list<std::string_view> words) {
    for (std::size_t begin = 0; begin <= channel.size();) {
        const auto end = std::min(channel.find('.', begin), channel.size());
        if (std::ranges::find(words, in_small_letters(std::string_view(channel).substr(
                                         begin, end - begin))) != words.end())
            return true;
        begin = end + 1;
    }
    return false;
}

}  // namespace

bool is_identity(const Image::Channel& channel, const std::vector<Image::Attribute>& attributes) {
    if (channel.depth == "uint" || channel.depth == "int") return true;
    if (has_part(channel.name, {"indexob", "indexma", "id", "objectid", "object_id", "objid",
                                "materialid", "material_id", "matid", "instanceid", "instance_id"}))
        return true;
    if (in_small_letters(channel.name).find("crypto") != std::string::npos) return true;
    // A layer may have any name, which the file states.
    return std::ranges::any_of(attributes, [&](const Image::Attribute& each) {
        return each.name.starts_with("cryptomatte/") && each.name.ends_with("/name") &&
               !each.value.empty() && channel.name.starts_with(each.value);
    });
}

std::vector<std::string> colours_of(const std::vector<std::string>& channels) {
    std::vector<std::string> best;
    int best_rank = 0;
    for (const auto& name : channels) {
        const auto dot = name.rfind('.');
        const auto layer = dot == std::string::npos ? std::string() : name.substr(0, dot + 1);
        const auto last = name.substr(layer.size());
        if (last != "R" && last != "r" && last != "red") continue;
        const bool small = last == "r", word = last == "red";
        std::vector<std::string> all{name,
                                     layer + (word    ? "green"
                                              : small ? "g"
                                                      : "G"),
                                     layer + (word    ? "blue"
                                              : small ? "b"
                                                      : "B")};
        if (std::ranges::any_of(all, [&](const std::string& each) {
                return std::ranges::find(channels, each) == channels.end();
            }))
            continue;
        if (is_identity({name, "float"}, {})) continue;
        const int rank =
            layer.empty()                                                                    ? 3
            : has_part(layer, {"combined", "beauty", "rgba", "rgb", "color", "colour", "c"}) ? 2
                                                                                             : 1;
        if (rank > best_rank) best = all, best_rank = rank;
    }
    return best;
}

bool is_depth(const std::string& channel) {
    return has_part(channel, {"z", "zback", "depth", "dist", "distance"});
}

bool depth_holds(const std::string& to, const std::string& from) {
    static const std::vector<std::pair<std::string, std::vector<std::string>>> holds{
        {"uint8", {"uint8"}},
        {"int8", {"int8"}},
        {"uint16", {"uint8", "uint16"}},
        {"int16", {"int16"}},
        {"half", {"uint8", "int8", "half"}},
        {"float", {"uint8", "int8", "uint16", "int16", "half", "float"}},
        {"double", {"uint8", "int8", "uint16", "int16", "half", "float", "double"}},
    };
    const auto found =
        std::ranges::find_if(holds, [&](const auto& each) { return each.first == to; });
    return found != holds.end() && std::ranges::find(found->second, from) != found->second.end();
}

}  // namespace fluidcarve
